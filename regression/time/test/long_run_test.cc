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

TEST(LongRun, ComplainsOfWhatALimitForbids) {
  const auto stall = [](double ratio, double more_ns) {
    LongRun r = run();
    r.worst_ratio = ratio;
    r.worst_more_ns = more_ns;
    r.worst_at = 100'000;
    return complaint(r);
  };
  EXPECT_EQ(stall(201, 1e6),
            "stalls: the 50 steps from sample 100000 on take 1005.0 us, 201.0 times as long as "
            "base's");
  EXPECT_EQ(stall(201, 4'000), "") << "too little to be told from an interrupt";
  EXPECT_EQ(stall(1.9, 1e6), "");

  const auto beside = [](const LifeTimes& base, const LifeTimes& head) {
    return complaint({.kernel = "k", .base = base, .head = head});
  };
  EXPECT_EQ(beside({.mean_ns = 100}, {.mean_ns = 100, .waits = 2}),
            "gives up the processor 2 times in a run, where base does so 0 times");
  EXPECT_EQ(beside({.mean_ns = 100, .waits = 2}, {.mean_ns = 100, .waits = 2}), "");
  EXPECT_EQ(beside({.mean_ns = 100}, {.mean_ns = 160}),
            "takes +60.0 % in the mean of a longer run (limit +50 %)");
  EXPECT_EQ(beside({.mean_ns = 100}, {.mean_ns = 140}), "");
}

}  // namespace
}  // namespace tauext::gate
