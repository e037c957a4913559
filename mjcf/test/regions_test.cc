// SPDX-License-Identifier: Apache-2.0
#include "mjcf/scenarios/regions.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <string>
#include <vector>

#include "mjcf/plant/plant.h"
#include "mjcf/record.h"
#include "mjcf/record_plain.h"
#include "mjcf/scenarios/region_runs.h"
#include "mjcf/scenarios/scenario.h"
#include "mjcf/test/error_of.h"

namespace tauext::test {
namespace {

using Eigen::Vector3d;

const Vector3d kUp(0.6, 0, 0.8);  // a direction in the plane of wallmobot3

// an arm that floats at rest, in the weight's balance, and one touch at 0.1 s
Scenario floating(const RegionTouch& touch, double duration) {
  Scenario s = quiet();
  s.duration = duration;
  s.floats = true;
  s.regions = {touch};
  s.regions[0].begin = 0.1;
  s.regions[0].direction = kUp;
  return s;
}

// [kg] of the arm at q = 0 against a push along kUp there, by MuJoCo's own inertia
double effective_mass(const Model& model, const std::string& point) {
  Plant plant(model);
  plant.set_state(Eigen::VectorXd::Zero(plant.dof()), Eigen::VectorXd::Zero(plant.dof()));
  const Eigen::VectorXd w = plant.tau_ext_of(kUp, plant.place(point));
  return 1 / w.dot(plant.inertia().inverse() * w);
}

struct Pulse {
  double peak = 0, duration = 0;  // [N], [s]
};
Pulse pulse_of(const Trace& trace) {
  Pulse p;
  for (const double f : trace.contact_force) {
    p.peak = std::max(p.peak, f);
    if (f > 0) p.duration += 1e-4;
  }
  return p;
}

// two masses and a spring between them: a half sine
TEST(Regions, AFreeOneIsHalfASineOfTheReducedMass) {
  const Model model = load_robot("wallmobot3");
  for (const BodyRegion& r : kBodyRegions) {
    for (const char* point : {"end_effector", "link5"}) {
      const RegionTouch touch{.region = &r, .at = {point, point, 0}, .speed = 0.1};
      const double arm = effective_mass(model, point);
      const double mu = reduced_mass(r, arm);
      EXPECT_NEAR(mu, r.mass * arm / (r.mass + arm), 1e-12 * mu);
      const double half = std::numbers::pi * std::sqrt(mu / r.stiffness);
      const Trace t = simulate(model, floating(touch, 0.2 + 1.5 * half), {.Ts = 1e-4});
      const Pulse p = pulse_of(t);
      const double peak = 0.1 * std::sqrt(mu * r.stiffness);
      EXPECT_NEAR(p.peak, peak, 0.02 * peak) << r.name << " at " << point;
      EXPECT_NEAR(p.duration, half, 0.02 * half + 1e-4) << r.name << " at " << point;
    }
  }
}

TEST(Regions, ASpeedCanBeAShareOfTheLimit) {
  for (const double share : {0.25, 0.5, 1.}) {
    RegionTouch touch{.region = &body_region("lower_arm"), .share_of_limit = share};
    const Trace t = simulate(load_robot("wallmobot3"), floating(touch, 0.3), {.Ts = 1e-4});
    EXPECT_NEAR(pulse_of(t).peak, share * 320, 0.02 * share * 320);
  }
}

// what the arm gets, the region loses: by the impulse of the recorded force, at another rate
TEST(Regions, SamplesOf1MsShowTheSamePulse) {
  const Model model = load_robot("wallmobot3");
  const RegionTouch touch{.region = &body_region("upper_arm"), .speed = 0.25};
  const auto impulse = [&](double Ts) {
    const Trace t = simulate(model, floating(touch, 0.3), {.Ts = Ts});
    double sum = 0;
    for (const double f : t.contact_force) sum += f * Ts;
    return sum;
  };
  const double mu = reduced_mass(*touch.region, effective_mass(model, "end_effector"));
  EXPECT_NEAR(impulse(1e-3), 2 * mu * 0.25, 0.02 * mu);
  EXPECT_NEAR(impulse(1e-4), impulse(1e-3), 1e-3 * mu);
}

TEST(Regions, TruthIsTheForcesTorqueAtItsPoint) {
  const Model model = load_robot("wallmobot3");
  const LinkPoint middle{"link4", "link5", 0.5};
  const Trace t = simulate(model, floating({.region = &body_region("chest"), .at = middle}, 0.3));
  Plant plant(model);
  const auto elbow = plant.place("link5"), before = plant.place("link4");
  int pressed = 0;
  for (int k = 0; k < t.size(); ++k) {
    plant.set_state(t.q.col(k), t.qd.col(k));
    const Vector3d f = t.contact_force[static_cast<std::size_t>(k)] * kUp;
    const Eigen::VectorXd w = 0.5 * plant.tau_ext_of(f, elbow) + 0.5 * plant.tau_ext_of(f, before);
    ASSERT_LT((w - t.tau_ext.col(k)).norm(), 1e-9 * std::max(1., w.norm())) << t.t[k];
    ASSERT_EQ(t.contact[static_cast<std::size_t>(k)] != 0, f.norm() > 0);
    pressed += f.norm() > 0;
    // (3), with the acceleration that MuJoCo found
    const Eigen::VectorXd left = plant.inertia() * t.qdd.col(k) + plant.bias() + t.friction.col(k) +
                                 t.tau_ext.col(k) - t.tau.col(k);
    ASSERT_LT(left.norm(), 1e-8 * t.tau.col(k).norm()) << t.t[k];
  }
  EXPECT_GT(pressed, 50);
  EXPECT_EQ(t.force.cols(), 0) << "no force on the end effector makes this truth";
}

TEST(Regions, AGrazeIsAsDeepAsItSaysAndACLampingIsARamp) {
  const Model model = load_robot("wallmobot3");
  RegionTouch graze{.meeting = Meeting::kGrazing, .region = &body_region("back")};
  graze.depth = 1e-3, graze.rise = 2e-3;  // so short that neither moves aside
  const Pulse p = pulse_of(simulate(model, floating(graze, 0.2), {.Ts = 1e-4}));
  EXPECT_NEAR(p.peak, 35, 1.5);
  EXPECT_NEAR(p.duration, 4e-3, 2e-4);
  RegionTouch clamp{.meeting = Meeting::kClamped, .region = &body_region("face")};
  clamp.force = 65, clamp.rise = 0.2, clamp.hold = 0.1, clamp.fall = 0.05;
  Scenario s = floating(clamp, 0.6);
  s.floats = false;
  const Trace t = simulate(model, s);
  for (int k = 0; k < t.size(); ++k) {
    const double since = t.t[k] - 0.1;
    const double wanted = since <= 0 || since >= 0.35 ? 0
                          : since < 0.2               ? 65 * since / 0.2
                          : since < 0.3               ? 65
                                                      : 65 * (0.35 - since) / 0.05;
    ASSERT_NEAR(t.contact_force[static_cast<std::size_t>(k)], wanted, 1e-9) << t.t[k];
  }
}

TEST(Regions, OurOwnDynamicsMakeTheSameTruthAsMuJoCo) {
  const Model model = load_robot("wallmobot3");
  Scenario s = quiet();
  s.duration = 4;
  s.reference = [](double t, int) { return sine_motion(0.1, 2, t); };
  for (const char* name : {"hand", "chest", "lower_arm"}) {
    RegionTouch t{.region = &body_region(name), .at = {"link4", "link5", 0.7}, .direction = kUp};
    t.begin = 0.5 + static_cast<double>(s.regions.size());
    s.regions.push_back(t);
  }
  s.regions[1].meeting = Meeting::kGrazing;
  s.regions[1].depth = 5e-3, s.regions[1].rise = 0.03;
  const std::vector<Scenario> all(3, s);
  const std::vector<Trace> ours = simulate_plain(model, all);
  const Trace truth = simulate(model, s);
  for (const Trace& t : ours) EXPECT_LT(difference(truth, t), 1e-9);
  EXPECT_GT(*std::max_element(truth.contact_force.begin(), truth.contact_force.end()), 50);
}

TEST(Regions, DrawnOnesAreWhatTheirClassSays) {
  const Model model = load_robot("wallmobot3");
  const TouchPoints points(model, Eigen::VectorXd::Zero(3));
  std::set<std::string> links;
  for (std::size_t c = 0; c < region_classes().size(); ++c) {
    const RegionClass& of = region_classes()[c];
    const std::vector<RegionTouch> all = points.draw(c, 5, 4, 30);
    ASSERT_GE(all.size(), 7u) << of.name;
    check(all);
    Plant plant(model);
    for (const RegionTouch& t : all) {
      ASSERT_GE(t.begin, 4);
      ASSERT_LE(t.end(), 30);
      ASSERT_EQ(t.meeting, of.meeting);
      ASSERT_EQ(t.direction.y(), 0) << "where the arm moves";
      if (of.meeting == Meeting::kClamped) {
        ASSERT_NEAR(t.ramp(t.begin + t.rise), of.limit(), 1e-9);
      }
      if (of.meeting == Meeting::kGrazing) {
        ASSERT_NEAR(t.stiffness() * t.overlap(t.begin + t.rise), of.limit() / 4, 1e-9);
        ASSERT_NEAR(t.overlap(t.end()), 0, 1e-12);
      }
      links.insert(t.at.from);
    }
  }
  EXPECT_EQ(links, (std::set<std::string>{"link2", "link4", "link5"}));
}

TEST(Regions, WhatCannotBeIsSaid) {
  const auto error = [](RegionTouch t) { return error_of([&] { check({t}); }); };
  EXPECT_EQ(error({.speed = -1}), "speed [m/s] is -1, and must be 0.001 to 5");
  EXPECT_EQ(error({.direction = {1, 1, 0}}),
            "the length of a direction is 1.4142135623730951, and must be 1 to 1");
  EXPECT_NE(error({.region = &body_region("face"), .share_of_limit = 1}).find("the face has no"),
            std::string::npos);
  EXPECT_NE(error_of([] {
              check({{.begin = 1}, {.begin = 1.001}});
            }).find("the begin [s] of a"),
            std::string::npos);
  EXPECT_NE(error_of([] { body_region("elbow"); }).find("unknown body region 'elbow'; known: hand"),
            std::string::npos);
  Scenario s = floating({.at = {"link4", "elbow", 0.5}}, 1);
  EXPECT_NE(error_of([&] { simulate(load_robot("wallmobot3"), s); }).find("'elbow'"),
            std::string::npos);
}

}  // namespace
}  // namespace tauext::test
