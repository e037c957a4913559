// SPDX-License-Identifier: Apache-2.0
#include "mjcf/record_plain.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "mjcf/plant/simulated.h"
#include "mjcf/scenarios/generic.h"
#include "mjcf/scenarios/touch.h"
#include "mjcf/test/error_of.h"

namespace tauext::test {
namespace {

using Eigen::MatrixXd;

// as difference() has it, of one quantity; rounding of what is hardly there does not count
double of(const MatrixXd& a, const MatrixXd& b) {
  return (a - b).cwiseAbs().maxCoeff() / std::max(1e-3, a.cwiseAbs().maxCoeff());
}

void expect_same(const Trace& a, const Trace& b) {
  EXPECT_LT(of(a.q, b.q), 1e-9);
  EXPECT_LT(of(a.qd, b.qd), 1e-9);
  EXPECT_LT(of(a.tau, b.tau), 1e-9);
  EXPECT_LT(of(a.tau_ext, b.tau_ext), 1e-9);
  EXPECT_LT(of(a.qdd, b.qdd), 1e-9);
  EXPECT_LT(of(a.friction, b.friction), 1e-9);
  EXPECT_EQ(a.t, b.t);
  EXPECT_EQ(a.contact, b.contact);
  ASSERT_EQ(a.force.cols(), b.force.cols());
  EXPECT_TRUE(a.force == b.force);
  EXPECT_LT(of(MatrixXd::Map(a.contact_force.data(), 1, a.size()),
               MatrixXd::Map(b.contact_force.data(), 1, b.size())),
            1e-9);
}

template <int N>
void expect_same_scenarios(const std::string& robot) {
  for (const Scenario& s : scenarios(robot)) {
    SCOPED_TRACE(robot + "/" + s.name);
    const Model arm = load_for(robot, s);
    expect_same(simulate(arm, s), simulate_plain<N>(arm, s));
  }
}

TEST(RecordPlain, IsMuJoCosTruthInEveryScenario) {
  expect_same_scenarios<3>("wallmobot3");
  expect_same_scenarios<1>("testbed1");
}

TEST(RecordPlain, StudiesSimulateWithoutMuJoCo) {
  for (const double panel : {0., 150.}) {
    const Model arm = wallmobot3_with_panel(panel);
    EXPECT_TRUE(plain_arm(arm).has_value());
    for (const TouchKind kind :
         {TouchKind::kBlow, TouchKind::kSlowPush, TouchKind::kBriskPush, TouchKind::kClamp}) {
      Scenario touched = touched_wallmobot3(kind, 7);
      touched.duration = 8;
      expect_same(simulate(arm, touched), simulate_plain<3>(arm, touched));
    }
  }
  const Model arm = simulated(load_mjcf(std::string(TAUEXT_EXAMPLES) + "/arm6.xml"));
  EXPECT_TRUE(plain_arm(arm).has_value());
  Scenario touched = touched_arm(scale_of(arm), TouchKind::kBlow, 7);
  touched.duration = 8;
  for (const Model& of :
       {arm, with_errors(arm, {.mass = 1.05}), with_errors(arm, {.friction_share = 0.05}),
        with_errors(arm, {.viscous = 2, .armature = 0.1})}) {
    expect_same(simulate(of, touched), simulate_plain<6>(of, touched));
  }
}

TEST(RecordPlain, WhatNeedsMuJoCoIsLeftToIt) {
  EXPECT_FALSE(plain_arm(load_robot("testbed1")).has_value()) << "its tip may touch the ground";
  const Model arm = wallmobot3_with_panel(0);
  EXPECT_FALSE(plain_arm(with_errors(arm, {.friction = 5})).has_value()) << "by the solver";
  // a limit ends a run, whoever simulates it
  const Model six = simulated(load_mjcf(std::string(TAUEXT_EXAMPLES) + "/arm6.xml"));
  Scenario far = quiet();
  far.reference = [](double t, int joint) { return Reference{joint == 0 ? 4 * t : 0, 0, 0}; };
  EXPECT_NE(error_of([&] { simulate_plain<6>(six, far); }).find("reaches its limit"),
            std::string::npos);
}

}  // namespace
}  // namespace tauext::test
