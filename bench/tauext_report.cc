// SPDX-License-Identifier: Apache-2.0
// tauext-report: results as one page for a browser.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <map>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "bench/program/program.h"
#include "bench/report/page.h"
#include "bench/report/result_files.h"
#include "mjcf/trace/atomic_file.h"
#include "mjcf/trace/printable.h"

namespace {

using namespace tauext;

// what has the name of another is named with its folder, or by a number
void tell_apart(std::vector<ResultFile>& all, const std::vector<std::string>& paths) {
  const auto has_twin = [&](std::size_t i) {
    return std::count_if(all.begin(), all.end(), [&](const ResultFile& r) {
             return r.kind == all[i].kind && r.name == all[i].name;
           }) > 1;
  };
  std::vector<std::size_t> twins;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (has_twin(i)) twins.push_back(i);
  }
  for (const std::size_t i : twins) {
    const std::string folder = std::filesystem::path(paths[i]).parent_path().filename().string();
    if (!folder.empty()) all[i].name = folder + "/" + all[i].name;
  }
  for (const std::size_t i : twins) {
    const std::string name = all[i].name;
    for (int n = 2; has_twin(i); ++n) all[i].name = fmt::format("{} ({})", name, n);
  }
}

std::vector<ResultFile> read_all(const std::vector<std::string>& paths) {
  std::map<std::string, std::string> seen;  // paths by what they hold
  std::vector<ResultFile> all;
  std::vector<std::string> from;  // the path of each
  for (const std::string& path : paths) {
    if (std::count(paths.begin(), paths.end(), path) > 1)
      throw std::invalid_argument(path + ": is there twice");
    for (ResultFile& r : report::read_results(path)) {
      const auto [before, is_new] = seen.emplace(r.json, path);
      if (!is_new && before->second != path)
        throw std::invalid_argument(
            fmt::format("{}: {} has the same results", path, before->second));
      if (!is_new) continue;  // a page of ours may hold them twice
      all.push_back(std::move(r));
      from.push_back(path);
    }
  }
  tell_apart(all, from);
  return all;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "Makes one page of results, for a browser: how accurate and fast everybody is, traces,\n"
      "fronts, studies, seeds, a gate's history, and a ranking of several submitters. The page\n"
      "holds everything, asks for nothing from anywhere, and can be read here again.\n\n"
      "  tauext-bench --benchmark_out=ours.json\n"
      "  tauext-report ours.json theirs.json study.json --out report.html\n",
      "tauext-report");
  std::vector<std::string> paths;
  std::string out;
  bool schema = false;
  app.add_option("results", paths,
                 "JSON of tauext-bench, -score, -detect; history.jsonl; other reports")
      ->type_name("FILE");
  app.add_option("-o,--out", out, "page to write, or - for standard output")
      ->type_name("FILE.html");
  app.add_flag("--schema", schema,
               "print what a file of results must be, as JSON Schema, and stop");
  return run_program(app, argc, argv, [&] {
    if (schema) {
      if (!paths.empty() || !out.empty())
        throw std::invalid_argument("--schema prints the schema, and takes nothing else");
      fmt::print("{}", results_schema());
      return kGood;
    }
    if (paths.empty() || out.empty())
      throw std::invalid_argument("files of results and --out FILE.html are needed; see --help");
    if (out != "-") report::require_page(out, "--out");
    AtomicFile file(out);
    file.write(report::page_of(read_all(paths)));
    file.commit();
    if (out != "-") say(out + ": open it in a browser");
    return kGood;
  });
}
