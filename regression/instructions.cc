// SPDX-License-Identifier: Apache-2.0
#include "regression/instructions.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gnu/libc-version.h>
#include <valgrind/callgrind.h>

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <iostream>
#include <nlohmann/json.hpp>
#include <regex>
#include <sstream>
#include <stdexcept>

#include "regression/child.h"
#include "regression/files.h"
#include "regression/plugin_host.h"

namespace tauext::gate {
namespace {

constexpr const char* kHeader = "# tauext instruction counts 1";
constexpr const char* kEnd = "# end";
constexpr int kWarm = 100;  // steps before the count
constexpr int kSteps = 1000;

// what glibc chooses its libm by, as this process sees it: under valgrind another processor than outside
std::string libm_variant() {
  std::vector<const char*> has;
  __builtin_cpu_init();
  if (__builtin_cpu_supports("avx2")) has.push_back("avx2");
  if (__builtin_cpu_supports("fma")) has.push_back("fma");
  if (__builtin_cpu_supports("fma4")) has.push_back("fma4");
  if (__builtin_cpu_supports("avx512f")) has.push_back("avx512f");
  return has.empty() ? "sse2" : fmt::format("{}", fmt::join(has, "+"));
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

std::uint64_t whole(const std::string& text, const std::string& path) {
  std::uint64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) {
    throw std::runtime_error(fmt::format("{}: '{}' is no count", path, text));
  }
  return value;
}

// "(7) name" defines, "(7)" recalls
std::string function_name(const std::string& text, std::map<std::string, std::string>& known) {
  const auto close = text.find(')');
  if (text.empty() || text[0] != '(' || close == std::string::npos) return text;
  std::string& name = known[text.substr(0, close + 1)];
  if (close + 2 < text.size()) name = text.substr(close + 2);
  return name;
}

}  // namespace

int count_main(const std::string& path, const std::string& filter) {
  const Plugin plugin(path);
  const std::regex wanted(filter);
  for (int i = 0; i < plugin.count(); ++i) {
    const std::string name = plugin.name(i);
    if (!std::regex_search(name, wanted)) continue;
    Work work(plugin, i, example(plugin, i));
    work.run(kWarm);
    CALLGRIND_START_INSTRUMENTATION;
    CALLGRIND_ZERO_STATS;
    work.run(kSteps);
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
  std::map<std::string, std::string> names;
  std::string function;
  bool called = false, total = false;  // the line after calls= is the callee's, not ours
  for (std::string line; std::getline(in, line);) {
    if (line.starts_with(kTrigger)) dump.trigger = line.substr(kTrigger.size());
    if (line.starts_with("fn=")) function = function_name(line.substr(3), names);
    if (line.starts_with("cfn=")) function_name(line.substr(4), names);
    if (line.starts_with("totals: ")) {
      dump.total = whole(line.substr(8), path);
      total = true;
    }
    if (line.starts_with("calls=")) {
      called = true;
    } else if (!line.empty() && (std::isdigit(static_cast<unsigned char>(line[0])) ||
                                 line[0] == '+' || line[0] == '-' || line[0] == '*')) {
      if (!called) dump.functions[function] += whole(line.substr(line.rfind(' ') + 1), path);
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
                                         read_file(folder.path() + "/log")));
  }
  Counts counts;
  counts.key = nlohmann::json::parse(run.output).get<Key>();
  counts.key["valgrind"] = version.output.substr(0, version.output.find('\n'));
  for (const auto& entry : std::filesystem::directory_iterator(folder.path())) {
    const std::string path = entry.path().string();
    if (!path.starts_with(out + ".")) continue;  // the last one, without a number, holds the rest
    const CallgrindDump dump = parse_callgrind(read_file(path), path);
    if (!std::regex_search(dump.trigger, wanted) || dump.trigger.empty()) continue;
    counts.kernels[dump.trigger] = dump.total;
    counts.functions[dump.trigger] = dump.functions;
  }
  return counts;
}

std::string counts_path(const std::string& folder, const Key& key) {
  std::uint32_t hash = 2166136261u;  // FNV-1a
  for (const auto& [name, value] : key) {
    for (const char c : fmt::format("{}={}\n", name, value)) {
      hash = (hash ^ static_cast<unsigned char>(c)) * 16777619u;
    }
  }
  return fmt::format("{}/instructions-{:08x}.tsv", folder, hash);
}

std::string format_counts(const Counts& counts) {
  std::string text = std::string(kHeader) + "\n";
  for (const auto& [name, value] : counts.key) text += fmt::format("# {}: {}\n", name, value);
  text += "kernel\tinstructions of 1000 steps\n";
  for (const auto& [kernel, count] : counts.kernels) text += fmt::format("{}\t{}\n", kernel, count);
  return text + kEnd + "\n";
}

Counts read_counts(const std::string& path) {
  std::istringstream in(read_file(path));
  Counts counts;
  std::string line;
  if (!std::getline(in, line) || line != kHeader) {
    throw std::runtime_error(
        fmt::format("{}: no instruction counts: it must begin with '{}'", path, kHeader));
  }
  bool end = false;
  while (!end && std::getline(in, line)) {
    const auto tab = line.find('\t'), colon = line.find(": ");
    if (line == kEnd) {
      end = true;
    } else if (line.starts_with("# ") && colon != std::string::npos) {
      counts.key[line.substr(2, colon - 2)] = line.substr(colon + 2);
    } else if (line.starts_with("kernel\t")) {
      continue;
    } else if (tab == std::string::npos || tab == 0) {
      throw std::runtime_error(fmt::format("{}: '{}' is no line of counts", path, line));
    } else {
      const std::string kernel = line.substr(0, tab);
      if (!counts.kernels.emplace(kernel, whole(line.substr(tab + 1), path)).second) {
        throw std::runtime_error(fmt::format("{}: {} is there twice", path, kernel));
      }
    }
  }
  if (!end)
    throw std::runtime_error(fmt::format("{}: cut off, its last line is not '{}'", path, kEnd));
  if (counts.kernels.empty()) throw std::runtime_error(path + ": holds no count");
  return counts;
}

std::optional<Counts> committed_counts(const std::string& folder, const Key& key) {
  const std::string path = counts_path(folder, key);
  if (!std::filesystem::exists(path)) return std::nullopt;
  Counts counts = read_counts(path);
  if (counts.key != key) {
    throw std::runtime_error(path + ": its key is not the one that its name was made from");
  }
  return counts;
}

std::vector<CountChange> compare_counts(const Counts& before, const Counts& after) {
  if (before.key != after.key) {
    throw std::invalid_argument("counts of different keys: " +
                                key_difference(before.key, after.key));
  }
  std::vector<CountChange> changes;
  for (const auto& [kernel, count] : after.kernels) {
    const auto old = before.kernels.find(kernel);
    if (old == before.kernels.end() || old->second == count) continue;
    CountChange c{.kernel = kernel, .before = old->second, .after = count};
    const auto was = before.functions.find(kernel), is = after.functions.find(kernel);
    if (was != before.functions.end() && is != after.functions.end()) {
      std::vector<std::pair<double, std::string>> gains;
      for (const auto& [function, n] : is->second) {
        const auto f = was->second.find(function);
        const double gain =
            static_cast<double>(n) - (f == was->second.end() ? 0 : static_cast<double>(f->second));
        if (gain > 0) gains.emplace_back(gain / kSteps, function);
      }
      std::sort(gains.rbegin(), gains.rend());
      for (std::size_t i = 0; i < std::min<std::size_t>(gains.size(), 3); ++i) {
        c.gained.push_back(
            fmt::format("{:+.1f} a step in {:.100}", gains[i].first, short_name(gains[i].second)));
      }
    }
    changes.push_back(std::move(c));
  }
  return changes;
}

std::string short_name(const std::string& name) {
  std::string out;
  int depth = 0;
  for (const char c : name) {
    if (c == '<' || c == '(') ++depth;
    if (depth == 0) out += c;
    if ((c == '>' || c == ')') && depth > 0) --depth;
  }
  return out;
}

std::string key_difference(const Key& there, const Key& here) {
  std::vector<std::string> parts;
  Key all = there;
  all.insert(here.begin(), here.end());
  const auto value = [](const Key& k, const std::string& name) {
    const auto it = k.find(name);
    return it == k.end() ? std::string("none") : it->second;
  };
  for (const auto& [name, ignored] : all) {
    if (value(there, name) == value(here, name)) continue;
    parts.push_back(
        fmt::format("{}: '{}' there, '{}' here", name, value(there, name), value(here, name)));
  }
  return fmt::format("{}", fmt::join(parts, "; "));
}

}  // namespace tauext::gate
