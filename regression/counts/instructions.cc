// SPDX-License-Identifier: Apache-2.0
#include "regression/counts/instructions.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gnu/libc-version.h>
#if __has_include(<valgrind/callgrind.h>)
#include <valgrind/callgrind.h>
#endif

#include <cctype>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <nlohmann/json.hpp>
#include <regex>
#include <sstream>
#include <stdexcept>
#include <string_view>
#include <vector>

#include "mjcf/trace/input_file.h"
#include "regression/host/child.h"
#include "regression/host/files.h"
#include "regression/host/plugin_host.h"

namespace tauext::gate {
namespace {

#ifdef CALLGRIND_START_INSTRUMENTATION
constexpr bool kCanCount = true;
#else
constexpr bool kCanCount = false;
#define CALLGRIND_START_INSTRUMENTATION
#define CALLGRIND_ZERO_STATS
#define CALLGRIND_DUMP_STATS_AT(name)
#define CALLGRIND_STOP_INSTRUMENTATION
#endif

constexpr int kWarm = 100;  // steps before the count

// what glibc chooses its libm by, as this process sees it: under valgrind another processor than
// outside
std::string libm_variant() {
#if defined(__x86_64__)
  std::vector<const char*> has;
  __builtin_cpu_init();
  if (__builtin_cpu_supports("avx2")) has.push_back("avx2");
  if (__builtin_cpu_supports("fma")) has.push_back("fma");
  if (__builtin_cpu_supports("fma4")) has.push_back("fma4");
  if (__builtin_cpu_supports("avx512f")) has.push_back("avx512f");
  return has.empty() ? "sse2" : fmt::format("{}", fmt::join(has, "+"));
#else
  return "not chosen by processor";
#endif
}

Key key_of(const Plugin& p) {
  return {{"arch",
#if defined(__x86_64__)
           "x86_64"
#elif defined(__aarch64__)
           "aarch64"
#else
           "other"
#endif
          },
          {"compiler", p.api().compiler},
          {"flags", p.api().flags},
          {"eigen", p.api().eigen},
          {"glibc", gnu_get_libc_version()},
          {"libm", libm_variant()}};
}

// "(7) name" defines, "(7)" recalls
std::string function_name(const std::string& text, std::map<std::string, std::string>& known) {
  const auto close = text.find(')');
  if (text.empty() || text[0] != '(' || close == std::string::npos) return text;
  std::string& name = known[text.substr(0, close + 1)];
  if (close + 2 < text.size()) name = text.substr(close + 2);
  return name;
}

// "././estimators/ekf.h" and "build/release/./estimators/ekf.h", as a mapped prefix makes them, and
// "./build/release/../../estimators/ekf.h", because ccache makes paths relative
std::string from_the_top(std::string_view file) {
  if (const auto top = file.rfind("/./"); top != file.npos) file.remove_prefix(top + 3);
  return std::filesystem::path(file).lexically_normal().generic_string();
}

}  // namespace

int count_main(const std::string& path, const std::string& filter) {
  const Plugin plugin(path);
  const std::regex wanted(filter);
  Lives lives(1, kWarm + kCountedSteps);
  for (int i = 0; i < plugin.count(); ++i) {
    const std::string name = plugin.name(i);
    if (!std::regex_search(name, wanted)) continue;
    Work work(plugin, i, lives.of(plugin, i));
    work.run(kWarm);
    CALLGRIND_START_INSTRUMENTATION;
    CALLGRIND_ZERO_STATS;
    work.run(kCountedSteps);
    CALLGRIND_DUMP_STATS_AT(name.c_str());
    CALLGRIND_STOP_INSTRUMENTATION;
  }
  std::cout << nlohmann::json(key_of(plugin)).dump();
  return 0;
}

CallgrindDump parse_callgrind(const std::string& text, const std::string& path) {
  if (text.rfind("# callgrind format", 0) != 0) {
    throw std::runtime_error(path + ": no file of callgrind's");
  }
  constexpr std::string_view kTrigger = "desc: Trigger: Client Request: ";
  CallgrindDump dump;
  std::istringstream in(text);
  std::map<std::string, std::string> names, files;
  std::string function, file;
  bool called = false, total = false;  // the line after calls= is the callee's, not ours
  for (std::string line; std::getline(in, line);) {
    if (line.starts_with(kTrigger)) dump.trigger = line.substr(kTrigger.size());
    if (line.starts_with("fn=")) function = function_name(line.substr(3), names);
    if (line.starts_with("cfn=")) function_name(line.substr(4), names);
    if (line.starts_with("cfi=") || line.starts_with("cfl=")) function_name(line.substr(4), files);
    if (line.starts_with("fl=") || line.starts_with("fi=") || line.starts_with("fe=")) {
      file = function_name(line.substr(3), files);
    }
    if (line.starts_with("totals: ")) {
      dump.total = whole_count(line.substr(8), path);
      total = true;
    }
    if (line.starts_with("calls=")) {
      called = true;
    } else if (!line.empty() && (std::isdigit(static_cast<unsigned char>(line[0])) ||
                                 line[0] == '+' || line[0] == '-' || line[0] == '*')) {
      const std::uint64_t count = whole_count(line.substr(line.rfind(' ') + 1), path);
      if (!called) dump.functions[function] += count;
      const int number = std::atoi(line.c_str());
      if (!called && number > 0) dump.lines[{from_the_top(file), number}] += count;
      called = false;
    }
  }
  if (!total) throw std::runtime_error(path + ": cut off, it has no totals");
  return dump;
}

Counts count_instructions(const std::string& plugin, const std::string& filter) {
  const std::regex wanted(filter);  // fails here and not in the child
  const TemporaryFolder folder;
  const std::string out = folder.path() + "/callgrind.out";
  if (!kCanCount)
    throw std::runtime_error(
        "instructions cannot be counted: valgrind/callgrind.h was missing at build; install "
        "Debian's valgrind, and build again");
  const Finished version = finish_child({"valgrind", "--version"});
  if (version.code != 0) {
    throw std::runtime_error("valgrind is missing; ci/install_deps installs it");
  }
  const Finished run =
      finish_child({"valgrind", "-q", "--tool=callgrind", "--instr-atstart=no", "--compress-pos=no",
                    "--log-file=" + folder.path() + "/log", "--callgrind-out-file=" + out,
                    this_program(), "count-worker", plugin, filter});
  if (run.code != 0) {
    throw std::runtime_error(fmt::format("{}: counting failed (exit code {}): {}", plugin, run.code,
                                         read_whole(folder.path() + "/log")));
  }
  Counts counts;
  counts.key = nlohmann::json::parse(run.output).get<Key>();
  counts.key["valgrind"] = version.output.substr(0, version.output.find('\n'));
  for (const auto& entry : std::filesystem::directory_iterator(folder.path())) {
    const std::string path = entry.path().string();
    if (!path.starts_with(out + ".")) continue;  // the last one, without a number, holds the rest
    const CallgrindDump dump = parse_callgrind(read_whole(path), path);
    if (!std::regex_search(dump.trigger, wanted) || dump.trigger.empty()) continue;
    counts.kernels[dump.trigger] = dump.total;
    counts.functions[dump.trigger] = dump.functions;
    counts.lines[dump.trigger] = dump.lines;
  }
  return counts;
}

}  // namespace tauext::gate
