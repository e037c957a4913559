// SPDX-License-Identifier: Apache-2.0
/// @file
/// Google Benchmark's flags. Not installed.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace tauext {

struct SuiteRun;

/// The most useful of them, for a program's help.
inline constexpr const char* kBenchmarkHelp =
    "  --benchmark_filter=REGEX --benchmark_out=FILE (JSON) --benchmark_min_time=0.05\n"
    "  --benchmark_repetitions=N --benchmark_format=console|json";

/// Takes Google Benchmark's flags out of a command line. It reads most of them itself;
/// --benchmark_out, --benchmark_format and --benchmark_out_format are read here.
class BenchmarkFlags {
 public:
  /// Initialises Google Benchmark, unless it is asked for --help. A benchmark takes 0.05 s if
  /// nobody says how long.
  BenchmarkFlags(int argc, char** argv);
  BenchmarkFlags(const BenchmarkFlags&) = delete;
  BenchmarkFlags& operator=(const BenchmarkFlags&) = delete;

  int argc() const { return argc_; }          ///< of what is left
  char** argv() { return pointers_.data(); }  ///< what is left

  /// @throws std::invalid_argument for a flag that is left although it looks like one of these
  void require_known() const;
  /// @throws std::invalid_argument for a filter that is no regular expression, and for an
  /// --benchmark_out_format other than json
  void require_values() const;

  /// A regular expression, maybe with a - before it; "" if every entry passes.
  std::string filter() const;
  /// Of --benchmark_out.
  const std::optional<std::string>& out() const { return out_; }
  /// Of --benchmark_format.
  const std::optional<std::string>& format() const { return format_; }

  /// Puts what the suite wants to know of these.
  void put(SuiteRun& run) const;

 private:
  std::optional<std::string> out_, format_, out_format_;
  bool list_tests_ = false;
  std::vector<std::string> texts_;
  std::vector<char*> pointers_;
  int argc_ = 0;
};

}  // namespace tauext
