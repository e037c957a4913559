// SPDX-License-Identifier: Apache-2.0
#include "mjcf/record_plain.h"

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include "mjcf/plant/simulated.h"
#include "mjcf/scenarios/generic.h"
#include "mjcf/scenarios/touch.h"
#include "mjcf/test/error_of.h"

namespace tauext::test {
namespace {

void expect_same(const Trace& a, const Trace& b) {
  EXPECT_LT(difference(a, b), 1e-9);
  EXPECT_EQ(a.contact, b.contact);
  ASSERT_EQ(a.force.cols(), b.force.cols());
  EXPECT_TRUE(a.force == b.force);
  for (int k = 0; k < a.size(); ++k) {
    const double force = a.contact_force[static_cast<std::size_t>(k)];
    ASSERT_NEAR(b.contact_force[static_cast<std::size_t>(k)], force, 1e-9 * std::max(1., force));
  }
}

// with dry friction by the solver
Model rubbing(const Model& arm) {
  return with_errors(arm, {.friction = 5});
}

TEST(RecordPlain, ADifferenceIsTheLargestOfAnyQuantity) {
  const Trace a = simulate(load_robot("testbed1"), scenario("testbed1", "manual"));
  for (const auto of :
       {&Trace::q, &Trace::qd, &Trace::qdd, &Trace::tau, &Trace::tau_ext, &Trace::friction}) {
    Trace b = a;
    (b.*of)(0, 100) += 2e-9 * std::max((a.*of).cwiseAbs().maxCoeff(), 1e-3);
    EXPECT_NEAR(difference(a, b), 2e-9, 1e-12);
  }
  Trace shorter = a;
  shorter.t.pop_back();
  EXPECT_FALSE(std::isfinite(difference(a, shorter)));
}

void expect_same_scenarios(const std::string& robot) {
  for (const Scenario& s : scenarios(robot)) {
    SCOPED_TRACE(robot + "/" + s.name);
    const Model arm = load_for(robot, s);
    expect_same(simulate(arm, s), simulate_plain(arm, s));
  }
}

TEST(RecordPlain, IsMuJoCosTruthInEveryScenario) {
  expect_same_scenarios("wallmobot3");
  expect_same_scenarios("testbed1");
}

TEST(RecordPlain, StudiesSimulateWithoutMuJoCo) {
  for (const double panel : {0., 150.}) {
    const Model arm = wallmobot3_with_panel(panel);
    EXPECT_TRUE(plain_arm(arm).has_value());
    for (const TouchKind kind :
         {TouchKind::kBlow, TouchKind::kSlowPush, TouchKind::kBriskPush, TouchKind::kClamp}) {
      Scenario touched = touched_wallmobot3(kind, 7);
      touched.duration = 8;
      for (const Model& of : {arm, rubbing(arm)}) {
        const Trace truth = simulate(of, touched), plain = simulate_plain(of, touched);
        expect_same(truth, plain);
        EXPECT_GT(difference(truth, plain), 0) << "MuJoCo took over";
      }
    }
  }
  const Model arm = simulated(load_mjcf("bench/examples/arm6.xml"));
  EXPECT_TRUE(plain_arm(arm).has_value());
  Scenario touched = touched_arm(scale_of(arm), TouchKind::kBlow, 7);
  touched.duration = 8;
  for (const Model& of :
       {arm, with_errors(arm, {.mass = 1.05}), with_errors(arm, {.friction_share = 0.05}),
        with_errors(arm, {.viscous = 2, .armature = 0.1})}) {
    expect_same(simulate(of, touched), simulate_plain(of, touched));
  }
}

TEST(RecordPlain, SeveralRunsAtOnceAreMuJoCosTruthEach) {
  const Model arm = wallmobot3_with_panel(50);
  std::vector<Scenario> runs;
  for (int i = 0; i < 7; ++i) {
    runs.push_back(touched_wallmobot3(static_cast<TouchKind>(i % 4), 20 + i));
    runs.back().duration = i < 5 ? 6 : 5;  // those of one length go together
  }
  for (const Model& of : {arm, rubbing(arm)}) {
    const std::vector<Trace> all = simulate_plain(of, runs);
    ASSERT_EQ(all.size(), runs.size());
    for (std::size_t i = 0; i < runs.size(); ++i) {
      SCOPED_TRACE(i);
      expect_same(simulate(of, runs[i]), all[i]);
    }
  }
}

TEST(RecordPlain, ARunThatComesNearALimitGoesOnInMuJoCoAndTheOthersWithoutIt) {
  const Model arm = simulated(load_mjcf("bench/examples/arm6.xml"));
  Scenario near = quiet(), free = quiet();
  near.duration = free.duration = 4;
  near.reference = [](double t, int joint) {  // of the first joint to 6.274 rad of 6.28
    const double half = joint == 0 ? 6.274 / 2 : 0;
    return Reference{half * (1 - std::cos(t)), half * std::sin(t), half * std::cos(t)};
  };
  const std::vector<Scenario> runs = {free, near, free};
  const std::vector<Trace> all = simulate_plain(arm, runs);
  EXPECT_GT(all[1].q.row(0).maxCoeff(), plain_arm(arm)->highest[0]);
  for (std::size_t i = 0; i < runs.size(); ++i) {
    SCOPED_TRACE(i);
    expect_same(simulate(arm, runs[i]), all[i]);
  }
}

TEST(RecordPlain, WhatNeedsMuJoCoIsLeftToIt) {
  EXPECT_FALSE(plain_arm(load_robot("testbed1")).has_value()) << "its tip may touch the ground";
  const Model dry = rubbing(wallmobot3_with_panel(0));
  const Model inexact = changed(dry, [](mjModel& m) { m.opt.tolerance = 1e-8; });
  EXPECT_FALSE(plain_arm(inexact).has_value());
  // this friction was made for steps of 1 ms
  const Recording finer{.substeps = 2};
  EXPECT_EQ(difference(simulate(dry, quiet(), finer), simulate_plain(dry, quiet(), finer)), 0);
  // a limit ends a run, whoever simulates it
  const Model six = simulated(load_mjcf("bench/examples/arm6.xml"));
  Scenario far = quiet();
  far.reference = [](double t, int joint) { return Reference{joint == 0 ? 4 * t : 0, 0, 0}; };
  Scenario near = quiet();
  near.duration = far.duration;
  for (const std::vector<Scenario>& runs : {std::vector{far}, std::vector{near, far}})
    EXPECT_NE(error_of([&] { simulate_plain(six, runs); }).find("reaches its limit"),
              std::string::npos);
}

}  // namespace
}  // namespace tauext::test
