// SPDX-License-Identifier: Apache-2.0
#include "regression/layers.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <regex>
#include <stdexcept>

#include "regression/child.h"
#include "regression/plugin_host.h"

namespace tauext::gate {
namespace {

namespace fs = std::filesystem;

void say(const GateOptions& o, const std::string& what) {
  if (o.progress) o.progress(what);
}

// every key that the folder has, and in what it differs
std::string other_keys(const std::string& folder, const Key& key) {
  std::string text;
  std::error_code missing;  // a folder that is not there holds no other key
  for (const auto& entry : fs::directory_iterator(folder, missing)) {
    const std::string name = entry.path().filename().string();
    if (!name.starts_with("instructions-")) continue;
    text +=
        fmt::format("\n    {} has {}", name, key_difference(read_counts(entry.path()).key, key));
  }
  return text;
}

void compare_with_committed(const GateOptions& o, InstructionReport& r) {
  const std::optional<Counts> committed = committed_counts(o.baselines, r.head->key);
  if (!committed) {
    r.no_baseline =
        fmt::format("no baseline for this key: {} is not there{}",
                    counts_path(o.baselines, r.head->key), other_keys(o.baselines, r.head->key));
    return;
  }
  const std::regex wanted(o.kernels);
  r.beside_committed = compare_counts(*committed, *r.head);
  for (const auto& [kernel, count] : r.head->kernels) {
    if (!committed->kernels.contains(kernel)) r.added.push_back(kernel);
  }
  for (const auto& [kernel, count] : committed->kernels) {
    if (std::regex_search(kernel, wanted) && !r.head->kernels.contains(kernel)) {
      r.gone.push_back(kernel);
    }
  }
}

InstructionReport compare_instructions(const GateOptions& o) {
  InstructionReport r;
  say(o, "counting instructions");
  r.head = count_instructions(o.head, o.kernels);
  r.kernels = static_cast<int>(r.head->kernels.size());
  if (!o.base.empty()) r.base = count_instructions(o.base, o.kernels);
  if (r.head->kernels.empty() && (!r.base || r.base->kernels.empty())) {
    throw std::invalid_argument(fmt::format("--kernels '{}' matches no kernel", o.kernels));
  }
  if (r.base && r.base->key == r.head->key) {
    r.beside_base = compare_counts(*r.base, *r.head);
  } else if (r.base) {
    r.other_key = key_difference(r.base->key, r.head->key);
  }
  compare_with_committed(o, r);
  return r;
}

void compare_golden(const GateOptions& o, GateResult& result) {
  const std::string path = golden_path(o.baselines);
  if (!fs::exists(path)) {
    result.accuracy.emplace().no_baseline =
        fs::absolute(path).string() + " is not there; --baselines FOLDER looks elsewhere";
    return;
  }
  const Golden baseline = read_golden(path);
  const std::regex wanted(o.entries);
  if (std::none_of(baseline.lines.begin(), baseline.lines.end(),
                   [&](const auto& line) { return std::regex_search(line.first.first, wanted); })) {
    throw std::invalid_argument(
        fmt::format("--entries '{}' matches nothing of {}", o.entries, path));
  }
  say(o, "scoring every entry");
  const Golden head = run_bench(o.bench, o.entries, "");
  result.accuracy = compare_accuracy(baseline, head, o.entries);
  say(o, "scoring the first seed again");
  const std::string seed = head.seeds.front();  // "seed 1"
  result.not_repeated =
      not_repeated(head, run_bench(o.bench, o.entries, seed.substr(seed.rfind(' ') + 1)));
}

}  // namespace

std::string golden_path(const std::string& folder) {
  return folder + "/accuracy.tsv";
}

Golden run_bench(const std::string& bench, const std::string& entries, const std::string& seeds) {
  const TemporaryFolder folder;
  const std::string out = folder.path() + "/golden.tsv";
  // a filter always, else Google Benchmark would take one from the environment
  std::vector<std::string> argv = {bench, "--golden", out,
                                   "--benchmark_filter=" + (entries.empty() ? "." : entries)};
  if (!seeds.empty()) argv.insert(argv.end(), {"--seeds", seeds});
  run_child(argv);
  return read_golden(out);
}

bool too_many(const CountChange& c) {
  return c.change() > kCountLimit;
}

GateResult run_layers(const GateOptions& options) {
  GateOptions o = options;
  GateResult r{.base = o.base, .head = o.head, .bench = o.bench};
  if (o.accuracy && o.bench.empty()) {
    if (!o.time && !o.instructions) throw std::invalid_argument("accuracy wants a --bench PROGRAM");
    r.notes.emplace_back("no --bench: accuracy was not looked at");
  }
  if (!o.base.empty() && (o.time || o.instructions)) {
    try {
      const TemporaryFolder folder;
      Plugin(folder.copy(o.base, "base.so"), o.base);
    } catch (const OtherAbi& e) {
      r.notes.push_back(fmt::format("{}: nothing to compare with", e.what()));
      o.base.clear();
    }
  }
  if (o.base.empty() && (o.time || o.instructions)) {
    r.notes.emplace_back("no base to compare with: head stands beside the committed counts alone");
  }
  if (o.time) {
    r.time = compare_times({.base = o.base,
                            .head = o.head,
                            .kernels = o.kernels,
                            .even_if_identical = o.even_if_identical,
                            .limits = o.limits,
                            .period = o.period,
                            .progress = o.progress});
  }
  if (o.instructions) r.instructions = compare_instructions(o);
  if (o.accuracy && !o.bench.empty()) compare_golden(o, r);
  return r;
}

GateCode exit_code(const GateResult& r) {
  bool harness = !r.not_repeated.empty(), slower = false, unsure = false, update = false;
  if (r.time) {
    update = !r.time->gone.empty();
    for (const KernelTime& k : r.time->alone) slower = slower || k.over_budget;
    for (const KernelTime& k : r.time->kernels) {
      harness = harness || (k.verdict.verdict == Verdict::kInconclusive && k.verdict.harness_error);
      slower = slower || k.verdict.verdict == Verdict::kFail || k.over_budget;
      unsure = unsure || k.verdict.verdict == Verdict::kInconclusive;
    }
  }
  if (r.instructions) {
    for (const auto* changes : {&r.instructions->beside_base, &r.instructions->beside_committed}) {
      slower = slower || std::any_of(changes->begin(), changes->end(), too_many);
    }
    unsure = unsure || !r.instructions->other_key.empty();  // two compilers: nothing is comparable
    update = update || !r.instructions->no_baseline.empty() || !r.instructions->added.empty() ||
             !r.instructions->gone.empty();
  }
  if (r.accuracy)
    update = update || !r.accuracy->no_baseline.empty() || !r.accuracy->changes.empty();
  if (harness) return kHarnessError;
  if (slower) return kSlower;
  if (r.accuracy && r.accuracy->worse() > 0) return kLessAccurate;
  if (update) return kUpdateNeeded;
  return unsure ? kInconclusive : kPassed;
}

}  // namespace tauext::gate
