// SPDX-License-Identifier: Apache-2.0
#include "estimators/samples/stillness.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "estimators/test/at_rest.h"

namespace tauext::test {
namespace {

TEST(Stillness, SaysWhenAMovingJointStandsStill) {
  AtRest r;
  const Measurement<3> moving = off(1, 0.004, 0.06, 0);
  std::vector<Status> all;
  for (int k = 0; k < 500; ++k) all.push_back(r.take(moving));
  EXPECT_EQ(std::count(all.begin(), all.end(), Status::kFrozen), 500 - 1);
  EXPECT_EQ(r.s.joints(), 2);
  EXPECT_EQ(r.take(off(1, 0.1, 0.2, 0)), Status::kBadTime) << "half a second later";
  EXPECT_EQ(r.take(off(1, 0.1, 0.2, 0)), Status::kBadTime);
  EXPECT_EQ(r.take(off(1, 0.1, 0.2, 0)), Status::kStarted);
  AtRest alone;  // qd goes on
  int good = 0;
  for (int k = 0; k < 500; ++k) {
    good += alone.take(off(1, 0.004, 0.5 + 1e-3 * (k % 2), 0)) == Status::kOk;
  }
  EXPECT_EQ(good, 1) << "0.5 mrad / 0.5 rad/s";
  AtRest coarse;  // an encoder of 4096 steps, which is known from its first one on
  for (int k = 0; k < 500; ++k) {
    const double step = 6.283185307179586 / 4096, qd = 0.5 + 1e-3 * (k % 2);
    const Status s = coarse.take(off(1, step * std::floor(5e-4 * k / step), qd, 0));
    if (k > 10) {
      EXPECT_EQ(s, Status::kOk) << k;
    }
  }
  Sampling<3> first(0.05, limits_of(WallMoBot3()));
  Measurement<3> y = off(1, 0, 0.1, 0);
  y.t = 100;
  EXPECT_EQ(first.accept(y), Status::kStarted) << "nothing came before";
  AtRest at_rest;  // no joint says that it moves, or not to speak of
  for (int k = 0; k < 500; ++k)
    EXPECT_EQ(at_rest.take(off(1, 0, 1e-9 * (k / 250), 0)), Status::kOk);
}

TEST(Stillness, ARepeatedSampleIsFrozenAtOnceUnlessTheSensorAlwaysRepeats) {
  AtRest r;
  double q = 0;
  const auto move = [&](double qd, int samples) { return off(1, q += 1e-3 * samples * qd, qd, 0); };
  const auto next = [&](int k) { return move(0.09 + 1e-5 * k, 1); };
  for (int k = 0; k < 1000; ++k) {
    const Measurement<3> y = next(k);
    const Status s = r.take(y);
    if (k > 10) {
      EXPECT_EQ(s, Status::kOk) << k;
    }
    if (k != 300 && k != 600) continue;  // 5 ms each, at 0.09 rad/s
    for (int i = 0; i < 5; ++i) EXPECT_EQ(r.take(y), Status::kFrozen);
    r.take(move(0.09 + 1e-5 * k, 6));
  }
  AtRest half;  // a sensor of 500 Hz
  q = 0;
  int frozen = 0;
  for (int k = 0; k < 500; ++k) {
    const Measurement<3> y = move(0.09 + 1e-5 * k, 2);
    for (int i = 0; i < 2; ++i) frozen += half.take(y) == Status::kFrozen;
  }
  EXPECT_EQ(frozen, 2);
}

// joint 2 swings by 0.1 rad at 1 Hz; what its sensors say of that
template <class Q, class Qd>
std::vector<Status> swing(AtRest& r, int samples, Q q, Qd qd) {
  std::vector<Status> all;
  for (int k = 0; k < samples; ++k) {
    const double phase = kTurn * 1e-3 * k;
    all.push_back(
        r.take(off(1, q(0.1 - 0.1 * std::cos(phase)), qd(0.1 * kTurn * std::sin(phase)), 0)));
  }
  return all;
}
double exact(double x) {
  return x;
}
auto in_steps(double step) {
  return [step](double x) { return step * std::floor(x / step); };
}

TEST(StillSpeed, IsFrozenOnceQHasLeftIt) {
  // from 0.1 s on qd stays at 0.37 rad/s; q is off by (2 pi)^2/2 0.1 cos(0.63) (t - 0.1)^2
  for (const int length : {50, 200}) {
    AtRest r;
    int k = 0;
    double last = 0;
    const auto all = swing(r, 1000, exact, [&](double qd) {
      return k++, k > 100 && k <= 100 + length ? last : last = qd;
    });
    const auto first = std::find(all.begin() + 20, all.end(), Status::kFrozen) - all.begin();
    EXPECT_NEAR(first, 99 + 27, 4) << "1.6 (t - 0.1)^2 = 5e-4 + 0.02 (t - 0.1) rad";
    EXPECT_EQ(std::count(all.begin() + first, all.end(), Status::kFrozen), 100 + length - first);
    EXPECT_EQ(std::count(all.begin() + 100 + length + 25, all.end(), Status::kOk), 875 - length);
    EXPECT_EQ(all.size(), 1000u);
  }
}

TEST(StillSpeed, ThatNeverRepeatsIsFrozenAtItsThirdRepetition) {
  AtRest r;  // at its fastest, where a speed that stays the same leads astray least
  int k = 0;
  double last = 0;
  const auto freeze = [&](double qd) { return k++, k > 240 && k <= 290 ? last : last = qd; };
  const auto all = swing(r, 500, exact, freeze);
  EXPECT_EQ(std::count(all.begin() + 20, all.begin() + 242, Status::kFrozen), 0);
  EXPECT_EQ(std::count(all.begin() + 242, all.begin() + 290, Status::kFrozen), 48);
  EXPECT_EQ(std::count(all.begin() + 300, all.end(), Status::kOk), 200);
}

TEST(StillSpeed, OfASensorOfFineStepsIsNotFrozen) {
  for (const double step : {1e-7, 1e-6, 1e-5, 1e-4, 1e-3}) {
    AtRest r;  // it repeats itself where it is fastest, and nowhere else
    const auto all = swing(r, 5000, exact, in_steps(step));
    EXPECT_LE(std::count(all.begin(), all.end(), Status::kFrozen), 3) << step << " rad/s";
    EXPECT_EQ(std::count(all.begin() + 1000, all.end(), Status::kFrozen), 0) << step << " rad/s";
  }
}

TEST(StillSpeed, OfAMotionThatBecomesEvenIsNotFrozenForLong) {
  AtRest r;  // noiseless, 0.5 rad/s after 0.4 s
  int frozen = 0, good = 0;
  double q = 0, qd = 0;
  for (int k = 0; k < 2000; ++k) {
    const double before = std::exchange(qd, std::min(0.5, 1.25e-3 * k));
    q += 0.5e-3 * (before + qd);
    const Status s = r.take(off(1, q, qd, 0));
    frozen += s == Status::kFrozen;
    good += s == Status::kOk;
  }
  EXPECT_LE(frozen, 250);
  EXPECT_GE(good, 2000 - 250 - 5);
}

TEST(StillSpeed, OfACoarseSensorIsNotFrozen) {
  for (const double q_step : {1e-7, 4.8e-5, 3.8e-4}) {  // 24, 17 and 14 bits
    for (const double qd_step : {1e-4, 1e-3, 0.01, 0.03, 0.05}) {
      AtRest r;
      const auto all = swing(r, 5000, in_steps(q_step), in_steps(qd_step));
      EXPECT_EQ(std::count(all.begin() + 1000, all.end(), Status::kFrozen), 0)
          << "steps of " << q_step << " rad and " << qd_step << " rad/s";
    }
  }
}

TEST(StillSpeed, OfAnArmThatHasCreptAndRestsIsNotFrozenForLong) {
  AtRest r;  // whose qd says 0 below 0.05 rad/s
  std::vector<Status> all;
  double q = 0;
  for (int k = 0; k < 1000; ++k) {
    q += 1e-3 * (k >= 100 && k < 140 ? 0.045 : 0);
    all.push_back(r.take(off(1, q, 0, 0)));
  }
  EXPECT_NE(std::count(all.begin(), all.end(), Status::kFrozen), 0);
  EXPECT_EQ(std::count(all.end() - 825, all.end(), Status::kOk), 825)
      << "1.8 mrad = 0.5 mrad + 0.02 rad/s 65 ms";
}

TEST(StillSpeed, IsNotOfOneThatWraps) {
  AtRest r;
  for (int k = 0; k < 100; ++k) {
    const double turn = k < 50 ? 0 : kTurn;
    EXPECT_EQ(r.take(off(1, 1e-5 * k - turn, 0.01, 0)), Status::kOk) << k;
  }
}

}  // namespace
}  // namespace tauext::test
