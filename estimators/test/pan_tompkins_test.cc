// SPDX-License-Identifier: Apache-2.0
#include "estimators/detectors/pan_tompkins.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <vector>

namespace tauext::test {
namespace {

// times of the marks on a signal at 1 kHz
std::vector<double> marks(PanTompkins d, double seconds,
                          const std::function<double(double)>& signal) {
  std::vector<double> at;
  for (int k = 0; k < std::lround(seconds * 1000); ++k) {
    const double t = k * 1e-3;
    if (d.update(t, Vec<1>(signal(t))).mark) at.push_back(t);
  }
  return at;
}

TEST(PanTompkins, ScoreOfARampIsItsSquaredSlopeOverTheThreshold) {
  PanTompkins d(1, {.threshold = Vec<1>(400)});
  Detection last;
  for (int k = 0; k < 100; ++k) {
    // uneven steps of 0.7 to 1.3 ms: a least-squares slope does not mind
    const double t = k * 1e-3 + (k % 2 ? 3e-4 : 0);
    last = d.update(t, Vec<1>(10 * t));
  }
  EXPECT_NEAR(last.score, 100. / 400, 1e-12);
}

TEST(PanTompkins, TheStrideSpacesThePointsOfTheDerivative) {
  // an alternating +-1 has slope (2 -1 0 +1 -2) . (1 -1 1 -1 1) / 10 T = 0 at odd strides and at
  // even ones too, but a single spike of height a enters by its largest weight 2 / (10 T)
  for (const int stride : {1, 5}) {
    PanTompkins d(1, {.stride = stride, .threshold = Vec<1>(1)});
    double highest = 0;
    for (int k = 0; k < 200; ++k) {
      highest = std::max(highest, d.update(k * 1e-3, Vec<1>(k == 100 ? 1. : 0.)).score);
    }
    const double slope = 0.2 / (stride * 1e-3);
    EXPECT_NEAR(highest, slope * slope, 1e-9 * slope * slope) << "stride " << stride;
  }
}

TEST(PanTompkins, MarksAJumpOnceAndWithin20Milliseconds) {
  const auto at = marks(PanTompkins(1), 2, [](double t) { return t < 1 ? 0 : 50; });
  ASSERT_EQ(at.size(), 1u);
  EXPECT_GE(at[0], 1);
  EXPECT_LE(at[0], 1.02);
}

TEST(PanTompkins, LeavesAHumanPushInPeaceWhateverTheLoadBeneath) {
  // 50 N m in 1 s along a minimum-jerk path, on loads of any size
  for (const double load : {0., 2000., -2000.}) {
    const auto at = marks(PanTompkins(1), 3, [=](double t) {
      const double s = std::clamp(t - 1, 0., 1.);
      return load + 50 * s * s * s * (10 - 15 * s + 6 * s * s);
    });
    EXPECT_TRUE(at.empty());
  }
}

TEST(PanTompkins, HoldsAndThenRefusesToMarkAgainTooSoon) {
  const auto pulses = [](double period) {
    return [=](double t) { return std::fmod(t, period) < 0.005 && t > 0.5 ? 50. : 0.; };
  };
  EXPECT_EQ(marks(PanTompkins(1), 2.05, pulses(0.5)).size(), 4u);
  // pulses 0.1 s apart: a mark at the earliest every 0.2 s
  const auto at = marks(PanTompkins(1), 2, pulses(0.1));
  for (std::size_t i = 1; i < at.size(); ++i) EXPECT_GE(at[i] - at[i - 1], 0.2 - 1e-9);
}

TEST(PanTompkins, ResetForgetsEverything) {
  PanTompkins d(1);
  std::vector<double> first, second;
  for (auto* scores : {&first, &second}) {
    d.reset();
    for (int k = 0; k < 100; ++k) scores->push_back(d.update(k * 1e-3, Vec<1>(k % 7)).score);
  }
  EXPECT_EQ(first, second);
}

}  // namespace
}  // namespace tauext::test
