// SPDX-License-Identifier: Apache-2.0
/// @file
/// The flags that are Google Benchmark's. Not installed.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "bench/run/suite/suite_run.h"

namespace tauext {

/// A command line without them: Google Benchmark has read its own, and here are those that we read
/// instead of it.
class BenchmarkFlags {
 public:
  /// Initialises Google Benchmark, unless it is asked for --help. A benchmark takes 0.05 s if
  /// nobody says how long.
  BenchmarkFlags(int argc, char** argv);
  BenchmarkFlags(const BenchmarkFlags&) = delete;
  BenchmarkFlags& operator=(const BenchmarkFlags&) = delete;

  int argc() const { return argc_; }          ///< of what is left
  char** argv() { return pointers_.data(); }  ///< what is left

  /// @throws std::invalid_argument for a flag that is left although it looks like Google
  /// Benchmark's, and for --benchmark_out_format other than json
  void require_known() const;

  /// The filter's regular expression, maybe with a - before it; "" if every entry passes.
  /// @throws std::invalid_argument for one that is none
  std::string filter() const;

  /// Puts --benchmark_out, --benchmark_format, --benchmark_list_tests and whether all entries pass.
  /// @throws as filter() does
  void put(SuiteRun& run) const;

  std::optional<std::string> out, format;  ///< of --benchmark_out and --benchmark_format

 private:
  std::optional<std::string> out_format_;
  bool list_tests_ = false;
  std::vector<std::string> texts_;
  std::vector<char*> pointers_;
  int argc_ = 0;
};

}  // namespace tauext
