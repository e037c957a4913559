// SPDX-License-Identifier: Apache-2.0
#include "regression/time/long_run.h"

#include <gtest/gtest.h>

namespace tauext::gate {
namespace {

LongRun run() {
  const LifeTimes times{.mean_ns = 100, .rare_ns = 200, .worst_ns = 12'000, .waits = 0};
  return {.kernel = "k", .base = times, .head = times};
}

TEST(LongRun, IsNoCauseForComplaintWhereNothingDiffers) {
  EXPECT_EQ(complaint(run()), "");
}

TEST(LongRun, ComplainsOfAStall) {
  LongRun r = run();
  r.worst_ratio = 201;
  r.worst_more_ns = 1e6;
  r.worst_at = 100'000;
  EXPECT_EQ(complaint(r),
            "stalls: the 50 steps from sample 100000 on take 1005.0 us, 201.0 times as long as "
            "base's");
  r.worst_more_ns = 4'000;
  EXPECT_EQ(complaint(r), "") << "too little to be told from an interrupt";
  r.worst_more_ns = 1e6;
  r.worst_ratio = 1.9;
  EXPECT_EQ(complaint(r), "");
}

TEST(LongRun, ComplainsOfAStepThatWaits) {
  LongRun r = run();
  r.head.waits = 2;
  EXPECT_EQ(complaint(r), "gives up the processor 2 times in a run, where base does so 0 times");
  r.base.waits = 2;
  EXPECT_EQ(complaint(r), "");
}

TEST(LongRun, ComplainsOfTheMean) {
  LongRun r = run();
  r.head.mean_ns = 160;
  EXPECT_EQ(complaint(r), "takes +60.0 % in the mean of a longer run (limit +50 %)");
  r.head.mean_ns = 140;
  EXPECT_EQ(complaint(r), "");
}

}  // namespace
}  // namespace tauext::gate
