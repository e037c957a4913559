// SPDX-License-Identifier: Apache-2.0
#include "mjcf/scenarios/touch.h"

#include <gtest/gtest.h>

#include <numbers>

namespace tauext::test {
namespace {

using Eigen::Vector3d;

TEST(Touch, RisesHoldsAndFallsAsItsKindSays) {
  const Vector3d f(60, 0, 80);  // 100 N
  const Touch blow{TouchKind::kBlow, 1, 0.02, 0, 0, f};
  EXPECT_NEAR(blow(1.01).norm(), 100, 1e-9);
  EXPECT_NEAR(blow(1.005).norm(), 100 * std::sin(std::numbers::pi / 4), 1e-9);
  EXPECT_EQ(blow(1.02).norm(), 0);
  const Touch push{TouchKind::kSlowPush, 1, 2, 1, 4, f};
  EXPECT_NEAR(push(2).norm(), 50, 1e-9) << "minimum jerk is half way after half the time";
  EXPECT_NEAR(push(3.5).norm(), 100, 1e-9);
  EXPECT_NEAR(push(6).norm(), 50, 1e-9);
  const Touch clamp{TouchKind::kClamp, 1, 2, 1, 4, f};
  EXPECT_NEAR(clamp(1.5).norm(), 25, 1e-9) << "a straight line";
  EXPECT_NEAR(clamp(7).norm(), 25, 1e-9);
  EXPECT_EQ(clamp(0.99).norm() + clamp(8).norm(), 0);
}

struct Range {
  TouchKind kind;
  double least, most;            // [N]
  double rise_least, rise_most;  // [s]
};

TEST(DrawTouches, StaysWithinTheRangesOfItsKindAndGoesAllWays) {
  for (const Range& r :
       {Range{TouchKind::kBlow, 100, 300, 0.01, 0.05}, Range{TouchKind::kSlowPush, 30, 80, 0.8, 2},
        Range{TouchKind::kBriskPush, 100, 100, 0.1, 0.1},
        Range{TouchKind::kClamp, 200, 200, 0.5, 1}}) {
    int count = 0;
    Eigen::Vector2i right_and_up = Eigen::Vector2i::Zero();
    for (std::uint64_t seed = 1; seed <= 40; ++seed) {
      double end = 4;
      for (const Touch& t : draw_touches(r.kind, seed, 4, 30)) {
        EXPECT_GE(t.begin, end);
        EXPECT_GE(t.force.norm(), r.least * (1 - 1e-12));
        EXPECT_LE(t.force.norm(), r.most * (1 + 1e-12));
        EXPECT_GE(t.rise, r.rise_least);
        EXPECT_LE(t.rise, r.rise_most);
        EXPECT_EQ(t.force.y(), 0);
        right_and_up += Eigen::Vector2i(t.force.x() > 0, t.force.z() > 0);
        end = t.end() + 1;
        ++count;
      }
      EXPECT_LE(end, 31);
    }
    EXPECT_GT(count, 100);
    // binomial: within 4 standard deviations of a half
    for (const int side : {right_and_up[0], right_and_up[1]}) {
      EXPECT_NEAR(side, 0.5 * count, 2 * std::sqrt(count));
    }
  }
}

TEST(DrawTouches, OfOneSeedAreTheSameAndOfTwoAreNot) {
  const auto first = [](std::uint64_t seed) {
    return draw_touches(TouchKind::kBlow, seed, 4, 30)[0].force;
  };
  EXPECT_EQ(first(7), first(7));
  EXPECT_NE(first(7), first(8));
}

TEST(WithTouches, ContactIsWhereABlowOrAClampingActsAndNotAPush) {
  for (const TouchKind kind :
       {TouchKind::kBlow, TouchKind::kSlowPush, TouchKind::kBriskPush, TouchKind::kClamp}) {
    const bool counts = kind == TouchKind::kBlow || kind == TouchKind::kClamp;
    const Scenario s = touched_wallmobot3(kind, 3);
    for (const Touch& t : touches_of_wallmobot3(kind, 3)) {
      const double middle = t.begin + t.rise / 2;
      EXPECT_EQ(s.contact(middle, {}), counts);
      EXPECT_EQ(s.force(middle, {}), t(middle));
      EXPECT_FALSE(s.contact(t.begin - 0.5, {}));
    }
  }
}

TEST(BriskMotion, IsQuickButNoQuickerThanItSays) {
  const Eigen::Vector3d home(0.4, -1, 0), reach(0.8, 0.3, 0.5);
  for (const bool training : {false, true}) {
    double fastest = 0, hardest = 0;
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
      const auto motion = brisk_motion(home, reach, seed, training);
      constexpr double h = 1e-5;
      for (double t = 0.0123; t < 29; t += 0.05) {
        for (int i = 0; i < 3; ++i) {
          const Reference now = motion(t, i), before = motion(t - h, i), after = motion(t + h, i);
          ASSERT_NEAR(now.qd, (after.q - before.q) / (2 * h), 1e-6);
          ASSERT_NEAR(now.qdd, (after.qd - before.qd) / (2 * h), 2e-2);
          ASSERT_LE(std::abs(now.q - home[i]), reach[i] + 1e-9);
          fastest = std::max(fastest, std::abs(now.qd));
          hardest = std::max(hardest, std::abs(now.qdd));
        }
      }
    }
    EXPECT_LT(fastest, 2.001);
    EXPECT_GT(fastest, 1.5);
    EXPECT_LT(hardest, 10.01);
    EXPECT_GT(hardest, 7);
  }
}

TEST(BriskMotion, FromPlaceToPlaceItRestsBetween) {
  const Eigen::Vector2d home(0, 0), reach(0.5, 0.5);
  const auto motion = brisk_motion(home, reach, 7, false);
  EXPECT_EQ(motion(0, 0).q, 0) << "from home";
  int rests = 0;
  for (int k = 1; k < 3000; ++k) {
    const auto still = [&](int at) {
      return motion(at * 0.01, 0).qd == 0 && motion(at * 0.01, 1).qd == 0;
    };
    rests += still(k) && !still(k - 1);
  }
  EXPECT_GT(rests, 10);
  EXPECT_NE(brisk_motion(home, reach, 8, false)(10, 0).q, motion(10, 0).q);
}

}  // namespace
}  // namespace tauext::test
