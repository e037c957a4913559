// SPDX-License-Identifier: Apache-2.0
#include "bench/cli.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <stdexcept>

#include "bench/robot.h"

namespace tauext {

namespace {

// "noise=1,offset=2" into the fields of these names
void parse_loadcell(const std::vector<std::string>& items, Loadcell& l) {
  const std::pair<const char*, double*> fields[] = {
      {"scale", &l.scale},           {"offset", &l.offset},
      {"hysteresis", &l.hysteresis}, {"nonlinearity", &l.nonlinearity},
      {"noise", &l.noise},           {"step", &l.step},
      {"full_scale", &l.full_scale}};
  for (const std::string& item : items) {
    const auto equals = item.find('=');
    const auto field = std::find_if(std::begin(fields), std::end(fields), [&](const auto& f) {
      return item.substr(0, equals) == f.first;
    });
    if (equals == std::string::npos || field == std::end(fields) ||
        !CLI::detail::lexical_cast(item.substr(equals + 1), *field->second)) {
      throw CLI::ValidationError(
          "--loadcell",
          fmt::format("'{}' is not KEY=NUMBER with a KEY of scale, offset [N], "
                      "hysteresis, nonlinearity [of full scale], noise [N], step [N], "
                      "full_scale [N]",
                      item));
    }
  }
}

// CLI11 takes a number that does not fit for the largest that does
std::string whole_number(const std::string& text) {
  std::uint64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error == std::errc() && end == text.data() + text.size()) return "";
  return fmt::format("{} is not a whole number from 0 to {}", text,
                     std::numeric_limits<std::uint64_t>::max());
}

}  // namespace

void add_recording_flags(CLI::App& app, Sensors& s, Recording& r) {
  app.add_option("--velocity_noise", s.velocity_noise, "standard deviation [rad/s]")
      ->capture_default_str();
  app.add_option("--encoder_step", s.encoder_step, "quantisation of q [rad]")
      ->capture_default_str();
  app.add_option("--loadcell_noise", s.loadcell_noise, "standard deviation [N m], on tau itself")
      ->capture_default_str();
  app.add_option("--seed", s.seed, "of the sensors' noise")
      ->check(whole_number, "WHOLE")
      ->capture_default_str();
  app.add_option_function<std::vector<std::string>>(
         "--loadcell", [&s](const std::vector<std::string>& v) { parse_loadcell(v, s.loadcell); },
         "faults of a screw's loadcell, like noise=1,offset=5 [N]")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->type_name("KEY=VALUE,..");
  app.add_option("--kp", r.Kp, "tracking stiffness [1/s^2], else the scenario's own");
  app.add_option("--kd", r.Kd, "tracking damping [1/s], else the scenario's own");
}

int run_program(CLI::App& app, int argc, char** argv, const std::function<int()>& body) {
  app.set_version_flag("--version", fmt::format("{} {}", app.get_name(), TAUEXT_VERSION));
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& e) {
    return app.exit(e);
  } catch (const CLI::ParseError& e) {
    fmt::print(stderr, "{0}: {1}\n{0}: see {0} --help\n", app.get_name(), e.what());
    return kCouldNotRun;
  }
  try {
    const int code = body();
    if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0) {
      throw std::runtime_error("cannot write to standard output");
    }
    return code;
  } catch (const std::exception& e) {
    fmt::print(stderr, "{}: {}\n", app.get_name(), e.what());
    return kCouldNotRun;
  }
}

void report_skipped(const SkippedRows& s, const std::string& log) {
  if (s.total() == 0) return;
  fmt::print(
      stderr,
      "{}: skipped {} rows: {} with a wrong number of fields, {} not a number, {} not finite, "
      "{} out of time order\n",
      log, s.total(), s.wrong_field_count, s.not_a_number, s.not_finite, s.time_order);
  for (const std::string& line : s.first) fmt::print(stderr, "  {}\n", line);
  if (s.total() > static_cast<int>(s.first.size())) fmt::print(stderr, "  ...\n");
}

void refuse_same_file(const std::string& log, const std::string& out) {
  std::error_code ignored;  // a file that is not there yet is no other file
  if (std::filesystem::equivalent(log, out, ignored)) {
    throw std::invalid_argument(fmt::format("--out {} is the log itself", out));
  }
}

std::string list_known() {
  std::string out;
  for (const Robot& r : robots()) {
    out += fmt::format("robot {}, {} joints\n  estimators  {}\n  detectors   {}\n", r.name, r.dof,
                       fmt::join(r.estimators, ", "), fmt::join(r.detectors, ", "));
    out += "  scenarios\n";
    for (const Scenario& s : scenarios(r.name))
      out += fmt::format("    {:<12} {}\n", s.name, s.description);
  }
  return out;
}

}  // namespace tauext
