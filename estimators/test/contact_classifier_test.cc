// SPDX-License-Identifier: Apache-2.0
// What an estimator of 30 or 100 rad/s makes of a touch on one joint, on top of an unknown payload
// that weighs 1500 N m and swings by 60 as the arm moves.
#include "estimators/detectors/contact_classifier.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <set>

namespace tauext::test {
namespace {

using Load = std::function<double(double)>;  // of the time since the touch began [s]

struct Verdict {
  std::set<Contact> said, marked;
  double first_mark = -1;  // [s] after the begin
};

// a touch at 6 s; the estimator has found the payload after 3 s, in which the detectors are silent
Verdict verdict(const Load& touch, double w, double swing = 60) {
  ContactClassifier::Parameters p;
  p.collision.start_up = p.clamping.start_up = 3;
  // the swing leaves 54 N m behind the baseline, a push of 60 adds as much, a clamping of 250 more
  p.clamping.threshold = Vec<3>::Constant(140);
  ContactClassifier d(3, p);
  Verdict v;
  double estimate = 0;
  for (int k = 0; k < 10000; ++k) {
    const double t = k * 1e-3, since = t - 6;
    const double truth = 1500 + swing * std::sin(t) + (since >= 0 ? touch(since) : 0);
    estimate += -std::expm1(-w * 1e-3) * (truth - estimate);
    const Detection x = d.update(t, Vec<3>(0, estimate, 0));
    if (t < 4) {
      EXPECT_FALSE(x.mark) << t;
      continue;
    }
    v.said.insert(x.contact);
    if (!x.mark) continue;
    v.marked.insert(x.contact);
    if (v.first_mark < 0) v.first_mark = since;
  }
  return v;
}

double minimum_jerk(double x) {
  x = std::min(std::max(x, 0.), 1.);
  return x * x * x * (10 + x * (6 * x - 15));
}

TEST(ContactClassifier, CallsABlowACollision) {
  for (const double height : {100., 300.}) {
    for (const double width : {0.01, 0.05}) {
      const Verdict v = verdict(
          [=](double t) { return t > width ? 0 : height * std::sin(std::numbers::pi * t / width); },
          100);
      EXPECT_EQ(v.marked, std::set{Contact::kCollision}) << height << " N m, " << width << " s";
      EXPECT_LT(v.first_mark, 0.025);
    }
  }
}

TEST(ContactClassifier, CallsASlowPushIntentionalAndNeverMore) {
  for (const double w : {30., 100.}) {
    for (const double rise : {0.8, 2.}) {
      const Verdict v = verdict(
          [=](double t) { return 60 * (minimum_jerk(t / rise) - minimum_jerk((t - rise) / rise)); },
          w, 0);
      EXPECT_TRUE(v.marked.empty()) << rise << " s";
      EXPECT_EQ(v.said, (std::set{Contact::kNone, Contact::kIntentional}));
    }
  }
}

TEST(ContactClassifier, IsNotMovedByAPayloadThatItDoesNotKnow) {
  const Verdict v = verdict([](double t) { return 60 * minimum_jerk(t); }, 30);
  EXPECT_TRUE(v.marked.empty()) << "a push on top of the swing";
}

TEST(ContactClassifier, CallsASoftClampingAClamping) {
  for (const double w : {30., 100.}) {
    for (const double rise : {0.5, 1.}) {
      const Verdict v = verdict([=](double t) { return 250 * std::min(1., t / rise); }, w);
      EXPECT_EQ(v.marked, std::set{Contact::kClamping}) << rise << " s";
      EXPECT_LT(v.first_mark, rise + 0.3);
    }
  }
}

TEST(ContactClassifier, CallsABlowThatEndsInAClampingBothInTurn) {
  const Verdict v = verdict([](double t) { return 300 * std::min(1., t / 0.02); }, 100);
  EXPECT_EQ(v.marked, (std::set{Contact::kCollision, Contact::kClamping}));
  EXPECT_LT(v.first_mark, 0.025);
}

TEST(ContactClassifier, MarksNoSecondClampingWithinItsRefractoryTime) {
  // a load that wanders around the limit every 0.3 s
  ContactClassifier d(3);
  double last = -1;
  for (int k = 0; k < 6000; ++k) {
    const double t = k * 1e-3;
    const double load = 160 + 60 * std::sin(2 * std::numbers::pi * t / 0.3);
    const Detection x = d.update(t, Vec<3>(0, load, 0));
    if (!x.mark || x.contact != Contact::kClamping) continue;
    if (last >= 0) {
      EXPECT_GE(t - last, 0.5 - 1e-9);
    }
    last = t;
  }
}

TEST(ContactClassifier, RefusesALevelOfZero) {
  ContactClassifier::Parameters p;
  p.intentional.setZero();
  EXPECT_THROW(ContactClassifier(3, p), std::invalid_argument);
}

}  // namespace
}  // namespace tauext::test
