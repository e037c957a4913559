// SPDX-License-Identifier: Apache-2.0
#include "regression/accuracy/accuracy_layer.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <regex>
#include <stdexcept>
#include <vector>

#include "mjcf/trace/input_file.h"
#include "regression/host/child.h"
#include "regression/host/files.h"

namespace tauext::gate {

std::string golden_path(const std::string& folder) {
  return folder + "/accuracy.tsv";
}

std::string run_bench(const std::string& bench, const std::string& entries,
                      const std::string& seeds) {
  const TemporaryFolder folder;  // a program of somebody else may print what it likes
  const std::string out = folder.path() + "/golden.tsv";
  // a filter always, else Google Benchmark would take one from the environment
  std::vector<std::string> argv = {bench, "--golden", out,
                                   "--benchmark_filter=" + (entries.empty() ? "." : entries)};
  if (!seeds.empty()) argv.insert(argv.end(), {"--seeds", seeds});
  run_child(argv);
  return read_whole(out);
}

AccuracyReport score_and_compare(const AccuracyOptions& o) {
  const std::string path = golden_path(o.baselines);
  if (!std::filesystem::exists(path)) {
    return {.no_baseline = std::filesystem::absolute(path).string() +
                           " is not there; --baselines FOLDER looks elsewhere"};
  }
  const Golden baseline = read_golden(path);
  const std::regex wanted(o.entries);
  if (std::none_of(baseline.lines.begin(), baseline.lines.end(),
                   [&](const auto& line) { return std::regex_search(line.first.first, wanted); })) {
    throw std::invalid_argument(
        fmt::format("--entries '{}' matches nothing of {}", o.entries, path));
  }
  const auto score = [&](const char* what, const std::string& seed) {
    if (o.progress) o.progress(what);
    return parse_golden(run_bench(o.bench, o.entries, seed), "what " + o.bench + " wrote");
  };
  const Golden head = score("scoring every entry", "");
  AccuracyReport report = compare_accuracy(baseline, head, o.entries);
  const std::string first = head.seeds.front();  // "seed 1"
  report.not_repeated =
      not_repeated(head, score("scoring the first seed again", first.substr(first.rfind(' ') + 1)));
  return report;
}

}  // namespace tauext::gate
