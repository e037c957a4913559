// SPDX-License-Identifier: Apache-2.0
#include "bench/run/suite/benchmark_flags.h"

#include <gtest/gtest.h>

#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "bench/run/suite/suite_run.h"

namespace tauext {
namespace {

// a command line, as main() has it
class CommandLine {
 public:
  explicit CommandLine(std::vector<std::string> texts) : texts_(std::move(texts)) {
    for (std::string& t : texts_) pointers_.push_back(t.data());
  }
  int argc() { return static_cast<int>(pointers_.size()); }
  char** argv() { return pointers_.data(); }

 private:
  std::vector<std::string> texts_;
  std::vector<char*> pointers_;
};

TEST(BenchmarkFlags, TheLastFileCountsAndWhatIsNotGoogleBenchmarksIsLeft) {
  CommandLine line({"program", "--benchmark_out=a.json", "--robot", "arm.xml", "--benchmark_out",
                    "b.json", "--benchmark_filter=all"});
  BenchmarkFlags flags(line.argc(), line.argv());
  flags.require_known();
  flags.require_values();
  SuiteRun run;
  flags.put(run);
  EXPECT_EQ(run.out, "b.json");
  EXPECT_EQ(run.filter, "") << "all";
  ASSERT_EQ(flags.argc(), 3);
  EXPECT_EQ(flags.argv()[1], std::string("--robot"));
  EXPECT_EQ(flags.argv()[2], std::string("arm.xml"));
}

TEST(BenchmarkFlags, WhatNobodyKnowsIsRefused) {
  CommandLine typo({"program", "--benchmark_fliter=step"});
  EXPECT_THROW(BenchmarkFlags(typo.argc(), typo.argv()).require_known(), std::invalid_argument);
  CommandLine csv({"program", "--benchmark_out_format=csv"});
  EXPECT_THROW(BenchmarkFlags(csv.argc(), csv.argv()).require_values(), std::invalid_argument);
  CommandLine bracket({"program", "--benchmark_filter=("});
  EXPECT_THROW(BenchmarkFlags(bracket.argc(), bracket.argv()).require_values(),
               std::invalid_argument);
}

}  // namespace
}  // namespace tauext
