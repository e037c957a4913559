// SPDX-License-Identifier: Apache-2.0
#include "mjcf/scenarios/motion.h"

#include <gtest/gtest.h>

#include <cmath>

namespace tauext::test {
namespace {

// speed and acceleration against central differences of the position, at times t
template <class Motion>
void expect_consistent(const Motion& m, const std::vector<double>& times) {
  constexpr double h = 1e-5;
  for (const double t : times) {
    const Reference r = m(t), before = m(t - h), after = m(t + h);
    EXPECT_NEAR(r.qd, (after.q - before.q) / (2 * h), 1e-8) << t;
    EXPECT_NEAR(r.qdd, (after.qd - before.qd) / (2 * h), 1e-6) << t;
  }
}

TEST(Motion, SpeedAndAccelerationAreItsDerivatives) {
  expect_consistent([](double t) { return sine_motion(0.3, 2, t); }, {0.1, 1, 7});
  const MinimumJerk jerk{.begin = 1, .duration = 2, .from = 0.4, .to = -0.2};
  expect_consistent([&](double t) { return reference_at(jerk, t); }, {0.5, 1.2, 2, 2.9, 3.5});
  const Trapezium trapezium{.begin = 1, .from = 0.4, .to = -0.2, .speed = 0.2, .acceleration = 1};
  expect_consistent([&](double t) { return reference_at(trapezium, t); }, {0.5, 1.1, 2, 4.1, 4.5});
}

TEST(Motion, MinimumJerkHasThePeakSpeedOfFlashAndHogan) {
  // 15/8 of the mean speed, in the middle
  const MinimumJerk m{.begin = 0, .duration = 2, .from = 0, .to = 1};
  EXPECT_NEAR(reference_at(m, 1).qd, 15. / 8 / 2, 1e-12);
  EXPECT_NEAR(reference_at(m, 1).q, 0.5, 1e-12);
}

TEST(Motion, ATrapeziumEndsWhereAndWhenItSays) {
  for (const double to : {0.6, -0.6, 0.02}) {
    const Trapezium m{.begin = 2, .from = 0.1, .to = to, .speed = 0.2, .acceleration = 1};
    EXPECT_EQ(reference_at(m, 2).q, 0.1);
    EXPECT_NEAR(reference_at(m, 2 + m.duration() - 1e-9).q, to, 1e-9);
    EXPECT_EQ(reference_at(m, 2 + m.duration()).q, to);
    double fastest = 0;
    for (double t = 2; t < 2 + m.duration(); t += 1e-3) {
      fastest = std::max(fastest, std::abs(reference_at(m, t).qd));
    }
    EXPECT_LE(fastest, 0.2 + 1e-12);
  }
}

TEST(Motion, BetweenMovesItRests) {
  const Moves<Trapezium> m(
      {{.begin = 1, .from = 0, .to = 0.2}, {.begin = 5, .from = 0.2, .to = 0}});
  EXPECT_EQ(m(0).q, 0);
  EXPECT_EQ(m(4).q, 0.2);
  EXPECT_EQ(m(4).qd, 0);
  EXPECT_EQ(m(20).q, 0);
}

}  // namespace
}  // namespace tauext::test
