// SPDX-License-Identifier: Apache-2.0
#include "bench/program/program.h"

#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cstdint>
#include <cstdio>
#include <limits>
#include <memory>
#include <regex>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "mjcf/trace/printable.h"
#include "mjcf/trace/text.h"

#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace tauext {

namespace {

// what CLI11 2.5 and later make of a text: paragraphs
template <class Formatter>
void leave_paragraphs_alone(Formatter& f) {
  if constexpr (requires { f.enable_footer_formatting(false); }) {
    f.enable_description_formatting(false), f.enable_footer_formatting(false);
    f.right_column_width(1000), f.long_option_alignment_ratio(0);
  }
}

// help without blanks at line ends and more than one empty line at once, which newer CLI11 has
class Help : public CLI::Formatter {
 public:
  explicit Help(const CLI::Formatter& as_it_is) : CLI::Formatter(as_it_is) {
    leave_paragraphs_alone(*this);
  }

  std::string make_help(const CLI::App* app, std::string name,
                        CLI::AppFormatMode mode) const override {
    const std::string text = CLI::Formatter::make_help(app, std::move(name), mode);
    std::string all;
    for (const char c : text) {
      while (c == '\n' && all.ends_with(' ')) all.pop_back();
      if (c != '\n' || !all.ends_with("\n\n")) all += c;
    }
    return all;
  }
};

void set_help(CLI::App& app) {
  if (const auto now = std::dynamic_pointer_cast<CLI::Formatter>(app.get_formatter()))
    app.formatter(std::make_shared<Help>(*now));
  for (CLI::App* const sub : app.get_subcommands({})) set_help(*sub);
}

// false if help or the version was asked for, which is then printed
bool parse(CLI::App& app, int argc, char** argv) {
  // what help hides, CLI11 does not name in an error either
  const auto hidden = app.get_options([](const CLI::Option* o) { return o->get_group().empty(); });
  for (CLI::Option* const o : hidden) o->group("hidden");
  try {
    app.parse(argc, argv);
    return true;
  } catch (const CLI::Success& e) {
    for (CLI::Option* const o : hidden) o->group("");
    std::ostringstream text;
    app.exit(e, text);
    fmt::print("{}", text.str());
    return false;
  }
}

}  // namespace

void keep_freed_memory() {
#ifdef __GLIBC__
  ::mallopt(M_MMAP_THRESHOLD, 32 << 20);  // bytes: the most that every version takes
  ::mallopt(M_TRIM_THRESHOLD, 1 << 30);
#endif
}

int run_program(CLI::App& app, int argc, char** argv, const std::function<int()>& body) {
  set_help(app);
  app.set_version_flag("--version", fmt::format("{} {}", app.get_name(), TAUEXT_VERSION));
  try {
    const int code = parse(app, argc, argv) ? body() : kGood;
    if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0) {
      throw std::runtime_error("cannot write to standard output");
    }
    return code;
  } catch (const CLI::ParseError& e) {
    say(fmt::format("{0}: {1}; see {0} --help", app.get_name(), one_line(e.what())));
    return kCouldNotRun;
  } catch (const std::exception& e) {
    say(fmt::format("{}: {}", app.get_name(), e.what()));
    return kCouldNotRun;
  }
}

void require_mode(const CLI::App& app, bool fits, const std::string& mode,
                  const std::vector<const char*>& flags) {
  for (const char* flag : flags) {
    if (fits || app.count(flag) == 0) continue;
    throw std::invalid_argument(
        fmt::format("{} goes with {}; see {} --help", flag, mode, app.get_name()));
  }
}

void add_robot_flags(CLI::App& app, std::string& robot, std::string& lock) {
  app.add_option("--robot", robot,
                 "robot (tauext-bench --list shows them), or a file of MJCF or URDF")
      ->type_name("NAME|FILE");
  app.add_option("--lock", lock, "joints of that file to fix, like grippers'")
      ->type_name("REGEX")
      ->check(not_empty);
}

std::string whole_number(const std::string& text) {
  if (number_in<std::uint64_t>(text)) return "";
  return fmt::format("{} is not a whole number from 0 to {}", text,
                     std::numeric_limits<std::uint64_t>::max());
}

std::string not_empty(const std::string& text) {
  if (text.starts_with("--")) return "its value is missing; " + text + " is the next flag";
  return text.empty() ? "its value is empty; leave it out" : "";
}

std::string regular_expression(const std::string& text) {
  try {
    std::regex{text};
    return "";
  } catch (const std::regex_error& e) {
    return fmt::format("no regular expression: {}", e.what());
  }
}

bool is_terminal(int stream) {
  return ::isatty(stream) == 1;
}

Progress::Progress(std::string what)
    : what_(std::move(what)), terminal_(is_terminal(STDERR_FILENO)) {}

void Progress::show(double share) {
  const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - begin_;
  show(fmt::format("{} [{:<40}] {:.0f} %, {:.0f} s left", what_,
                   std::string(static_cast<std::size_t>(40 * share), '='), 100 * share,
                   share > 0 ? spent.count() * (1 - share) / share : 0));
}

void Progress::show(const std::string& line) {
  if (!terminal_) return;
  fmt::print(stderr, "\r\033[K{}", printable_name(line, line.size()));
  std::fflush(stderr);
  dirty_ = true;
}

void Progress::clear() {
  if (std::exchange(dirty_, false)) fmt::print(stderr, "\r\033[K");
}

std::function<void(double)> Progress::callback() {
  if (!terminal_) return nullptr;
  return [this](double share) { show(share); };
}

}  // namespace tauext
