// SPDX-License-Identifier: Apache-2.0
#include "bench/run/suite/benchmark_flags.h"

#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>
#include <string_view>

#include "bench/program/program.h"
#include "bench/run/suite/reporter.h"
#include "bench/run/suite/suite_run.h"

namespace tauext {
namespace {

// takes every --name=value (or --name value) out of argv; the last one counts
std::optional<std::string> take_flag(std::vector<std::string>& args, const std::string& name) {
  std::optional<std::string> value;
  for (std::size_t i = 1; i < args.size();) {
    const bool with_value = args[i].starts_with(name + "=");
    if (!with_value && (args[i] != name || i + 1 == args.size())) {
      ++i;
      continue;
    }
    value = with_value ? args[i].substr(name.size() + 1) : args[i + 1];
    const auto at = args.begin() + static_cast<std::ptrdiff_t>(i);
    args.erase(at, at + (with_value ? 1 : 2));
  }
  return value;
}

// what is missing behind a number of seconds
const char* missing_unit(const std::string& text) {
  const bool lacks = !kBenchmark17<> && text.starts_with("--benchmark_min_time=") &&
                     text.back() >= '0' && text.back() <= '9';
  return lacks ? "s" : "";
}

}  // namespace

BenchmarkFlags::BenchmarkFlags(int argc, char** argv) : texts_(argv, argv + argc) {
  out_ = take_flag(texts_, "--benchmark_out");
  format_ = take_flag(texts_, "--benchmark_format");
  out_format_ = take_flag(texts_, "--benchmark_out_format");
  const auto given = [&](std::string_view flag) {
    return std::any_of(texts_.begin(), texts_.end(),
                       [&](const std::string& text) { return text.starts_with(flag); });
  };
  const bool help = given("--help") || given("-h");
  if (!help && !given("--benchmark_min_time"))  // its own 0.5 s would be minutes
    texts_.insert(texts_.begin() + 1, "--benchmark_min_time=0.05");
  for (std::string& text : texts_) text += missing_unit(text);
  list_tests_ = given("--benchmark_list_tests");
  for (std::string& text : texts_) pointers_.push_back(text.data());
  argc_ = static_cast<int>(pointers_.size());
  pointers_.push_back(nullptr);
  if (!help) benchmark::Initialize(&argc_, pointers_.data());
}

void BenchmarkFlags::require_known() const {
  for (int i = 1; i < argc_; ++i) {
    const std::string_view flag = pointers_[static_cast<std::size_t>(i)];
    if (!flag.starts_with("--benchmark_")) continue;
    throw std::invalid_argument(fmt::format(
        "{}: {}", flag,
        flag.starts_with("--benchmark_context=")
            ? "write KEY=VALUE,KEY=VALUE; a value cannot contain a comma"
            : "Google Benchmark does not know this flag, or not with this value; see --help"));
  }
}

void BenchmarkFlags::require_values() const {
  const std::string expression = filter();
  const std::string pattern = expression.starts_with('-') ? expression.substr(1) : expression;
  if (const std::string trouble = regular_expression(pattern); !trouble.empty())
    throw std::invalid_argument(fmt::format("--benchmark_filter={}: {}", expression, trouble));
  if (out_format_.value_or("json") == "json") return;
  throw std::invalid_argument(
      "--benchmark_out_format: json is the only format; rows have different counters");
}

std::string BenchmarkFlags::filter() const {
  const std::string filter = benchmark::GetBenchmarkFilter();
  return filter == "." || filter == "all" ? "" : filter;
}

void BenchmarkFlags::put(SuiteRun& run) const {
  run.filter = filter();
  run.list_tests = list_tests_;
  run.display = format_;
  run.out = out_;
}

}  // namespace tauext
