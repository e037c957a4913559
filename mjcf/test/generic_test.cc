// SPDX-License-Identifier: Apache-2.0
#include "mjcf/scenarios/generic.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>

#include "mjcf/plant/any_tree.h"
#include "mjcf/plant/simulated.h"
#include "mjcf/record.h"
#include "mjcf/test/error_of.h"

namespace tauext::test {
namespace {

using Eigen::VectorXd;

struct Arm {
  const char* name;
  const char* file;
  const char* lock;
};
constexpr Arm kArms[] = {{"arm6", "arm6.xml", ""},
                         {"arm6_as_measured", "arm6.json", ""},
                         {"arm7", "arm7.xml", "finger.*"},
                         {"two_arms", "two_arms.urdf", ""},
                         {"arm7_with_gripper", "arm7.xml", ""}};  // a finger follows the other
void PrintTo(const Arm& arm, std::ostream* out) {
  *out << arm.name;
}

Model model_of(const Arm& arm) {
  return simulated(load_mjcf(fmt::format("bench/examples/{}", arm.file), {arm.lock}));
}

// the largest |B qdd + bias + F + tau_ext - tau|, B and bias by our own dynamics
template <int N>
double residual(const Trace& t, const Model& model) {
  const AnyTree<N> arm = any_tree<N>(model);
  double worst = 0;
  for (int k = 0; k < t.size(); ++k) {
    const Vec<N> q = t.q.col(k), qd = t.qd.col(k), qdd = t.qdd.col(k);
    const Vec<N> r = arm.inertia(q) * qdd + arm.bias(q, qd) + Vec<N>(t.friction.col(k)) +
                     Vec<N>(t.tau_ext.col(k)) - Vec<N>(t.tau.col(k));
    worst = std::max(worst, r.cwiseAbs().maxCoeff());
  }
  return worst;
}

class Generic : public testing::TestWithParam<Arm> {};

// with limits of joints enabled
TEST_P(Generic, ObeysEquationThreeAtEverySample) {
  const Model model = model_of(GetParam());
  const std::vector<Scenario> all = generic_scenarios(model);
  ASSERT_EQ(all.size(), 10U);
  for (const Scenario& s : all) {
    const Trace t = record(model, s);
    const double worst = t.dof() == 6   ? residual<6>(t, model)
                         : t.dof() == 7 ? residual<7>(t, model)
                                        : residual<8>(t, model);
    EXPECT_LT(worst, 1e-9 * t.tau.cwiseAbs().maxCoeff()) << s.name;
    const bool touched = s.name == "blow" || s.name == "clamp" || s.name == "contact";
    EXPECT_EQ(std::count(t.contact.begin(), t.contact.end(), 1) > 0, touched) << s.name;
    const bool loaded = s.name != "free" && s.name != "in_motion";
    EXPECT_EQ(t.tau_ext.cwiseAbs().maxCoeff() > 0, loaded) << s.name;
  }
}

TEST_P(Generic, StaysInTheMiddleHalfOfEveryRange) {
  const Model model = model_of(GetParam());
  const ArmTree arm = tree_of(model);
  const VectorXd middle = (arm.lower + arm.upper) / 2, half = (arm.upper - arm.lower) / 2;
  for (const Scenario& s : generic_scenarios(model)) {
    const Trace t = record(model, s);
    for (int j = 0; j < t.dof(); ++j) {
      if (!std::isfinite(half[j])) continue;
      const double way = (t.q.row(j).array() - middle[j]).abs().maxCoeff();
      EXPECT_LT(way, 0.6 * half[j]) << s.name << ", joint " << j + 1;
    }
  }
}

// a load is what a joint is used to: none is a joke, none tears the arm away
TEST_P(Generic, MovesEveryJointByAHandsBreadthAtMost) {
  const Model model = model_of(GetParam());
  const std::vector<Scenario> all = generic_scenarios(model);
  const Trace free = record(model, all[0]);
  ASSERT_EQ(all[1].name, "step");
  const Trace t = record(model, all[1]);
  const VectorXd way = (t.q - free.q).cwiseAbs().rowwise().maxCoeff();
  EXPECT_LT(way.maxCoeff(), 0.1) << way.transpose();
  EXPECT_GT(way.maxCoeff(), 0.005) << way.transpose();
  const ArmScale scale = scale_of(model);
  EXPECT_LT((scale.torque - scale.usual_torque / 5).maxCoeff(), 1e-12);
  EXPECT_GE((scale.usual_torque - tree_of(model).usual_torque).minCoeff(), 0);
}

TEST_P(Generic, TouchesOfStudiesAreDrawnInItsPlane) {
  const ArmScale scale = scale_of(model_of(GetParam()));
  ASSERT_GT(scale.force, 1);
  EXPECT_LE(scale.force, 300);
  const Eigen::Vector3d normal = scale.directions.col(0).cross(scale.directions.col(1));
  for (const TouchKind kind : {TouchKind::kBlow, TouchKind::kSlowPush, TouchKind::kClamp}) {
    const std::vector<Touch> all = touches_of(scale, kind, 7);
    ASSERT_GT(all.size(), 2U);
    for (const Touch& t : all) {
      EXPECT_NEAR(t.force.dot(normal), 0, 1e-9);
      EXPECT_LE(t.force.norm(), (kind == TouchKind::kBlow ? scale.blow : scale.force) * (1 + 1e-9));
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Arms, Generic, testing::ValuesIn(kArms),
                         [](const auto& i) { return i.param.name; });

class OneJoint : public testing::Test {
 protected:
  // a rod that hangs from a hinge at the world's origin
  static Model rod(const std::string& joint, const std::string& site = "",
                   const std::string& motor = "") {
    const auto path =
        std::filesystem::temp_directory_path() / fmt::format("tauext_rod_{}.xml", ::getpid());
    std::ofstream(path)
        << "<mujoco><option integrator='RK4' timestep='0.001'/><worldbody><body><joint name='j' "
        << joint << "/><inertial pos='0 0 -.5' mass='2' diaginertia='.1 .1 .01'/>" << site
        << "</body></worldbody><actuator><motor joint='j' " << motor << "/></actuator></mujoco>";
    const Model model = simulated(load_mjcf(path.string()));
    std::filesystem::remove(path);
    return model;
  }
  static Scenario swing(double to) {
    Scenario s = quiet();
    s.name = "swing";
    s.duration = 3;
    s.reference = [to](double t, int) {
      return reference_at(MinimumJerk{.begin = 0, .duration = 2, .from = 0, .to = to}, t);
    };
    return s;
  }
};

// 2 kg at 0.5 m: m g l; 10 rad/s^2 of m l^2 + 0.1
TEST_F(OneJoint, UsualTorqueIsThatOfGravityOrOfItsInertia) {
  EXPECT_NEAR(tree_of(rod("axis='0 1 0'")).usual_torque[0], 2 * 9.81 * 0.5, 0.01);
  EXPECT_NEAR(tree_of(rod("axis='0 0 1'")).usual_torque[0], 10 * 0.01, 1e-9);
  EXPECT_NEAR(tree_of(rod("axis='0 1 0' limited='true' range='-60 60'")).usual_torque[0],
              2 * 9.81 * 0.5 * std::sqrt(0.75), 0.1);
}

TEST_F(OneJoint, ARunThatReachesALimitNamesJointAndTime) {
  const Model model = rod("axis='0 1 0' limited='true' range='-30 30'");
  EXPECT_EQ(error_of([&] { record(model, swing(0.5)); }), "no error");
  const std::string error = error_of([&] { record(model, swing(0.6)); });
  EXPECT_NE(error.find("swing: joint 1 reaches its limit at t = 1."), std::string::npos) << error;
}

// m g l sin(q) + B qdd + tau_ext = tau, by hand, with the stop in tau_ext
TEST_F(OneJoint, AStopThatIsMeantIsPartOfTheTruth) {
  const Model model = rod("axis='0 1 0' limited='true' range='-30 30'");
  Scenario s = swing(0.6);
  s.reaches_limits = true;
  const Trace t = record(model, s);
  double worst = 0;
  for (int k = 0; k < t.size(); ++k) {
    const double gravity = 2 * 9.81 * 0.5 * std::sin(t.q(0, k));
    worst = std::max(worst, std::abs(0.6 * t.qdd(0, k) + gravity + t.tau_ext(0, k) - t.tau(0, k)));
  }
  EXPECT_LT(worst, 1e-9);
  EXPECT_EQ(t.tau_ext(0, 500), 0);
  EXPECT_GT(t.tau_ext(0, 2900), 1) << "the controller presses on";
}

TEST_F(OneJoint, TheEndEffectorIsASiteOrTheLastLinksCentre) {
  const auto height = [](const Model& model) {
    Plant plant(model);
    plant.set_state(VectorXd::Zero(1), VectorXd::Zero(1));
    return plant.end_effector().position.z();
  };
  const std::string hinge = "axis='0 1 0'";
  EXPECT_EQ(height(rod(hinge)), -0.5);
  EXPECT_EQ(height(rod(hinge, "<site name='attachment_site' pos='0 0 -.8'/>")), -0.8);
  EXPECT_EQ(height(rod(hinge,
                       "<site name='attachment_site' pos='0 0 -.8'/>"
                       "<site name='end_effector' pos='0 0 -.9'/>")),
            -0.9);
}

// whose lever is 0.5 m; one that could not hold the rod, 9.81 N m, says nothing
TEST_F(OneJoint, NothingPushesHarderThanTheDriveHolds) {
  const auto force = [](const std::string& motor) {
    return scale_of(rod("axis='0 1 0'", "", motor)).force;
  };
  EXPECT_GT(force(""), 23);
  EXPECT_NEAR(force("ctrllimited='true' ctrlrange='-10 10'"), 10 / 0.5, 1e-6);
  EXPECT_NEAR(force("ctrllimited='true' ctrlrange='-1 1'"), 9.81 / 0.5, 0.1);
}

// 9.81 N m of gravity, 0.6 kg m^2, a lever of 0.5 m; a controller of 20 rad/s that gives way by
// 0.05 rad, of which the impulse of a half sine takes v / (e w)
TEST_F(OneJoint, LoadsAndBlowsFollowTheEffortOfADriveWithoutARotor) {
  const auto scale = [](const std::string& motor, const std::string& joint = "") {
    return scale_of(rod("axis='0 1 0' " + joint, "", motor));
  };
  const auto effort = [](const char* most) {
    return fmt::format("ctrllimited='true' ctrlrange='-{0} {0}'", most);
  };
  for (const auto& [most, load] : {std::pair("40", 40 / 5.), {"50", 50 / 5.}, {"90", 12.}}) {
    const ArmScale s = scale(effort(most));
    EXPECT_TRUE(s.by_effort);
    EXPECT_NEAR(s.usual_torque[0], std::stod(most), 1e-9);
    EXPECT_NEAR(s.torque[0], load, 1e-9) << most << ": 400 * 0.05 * 0.6 N m give way by 0.05 rad";
    EXPECT_NEAR(s.blow, std::stod(most) / 0.5, 1e-9);
    EXPECT_NEAR(s.force, 12 / 0.5, 1e-9) << "what is held lasts";
  }
  const ArmScale none = scale("");
  EXPECT_FALSE(none.by_effort);
  EXPECT_EQ(none.blow, none.force);
  // placeholders: of any arm, of one that could not hold it, and of one whose rotor says more
  for (const ArmScale& s : {scale(effort("1000")), scale(effort("1e6"))}) {
    EXPECT_FALSE(s.by_effort);
    EXPECT_EQ(s.usual_torque, none.usual_torque);
    EXPECT_EQ(s.torque, none.torque);
    EXPECT_EQ(s.blow, none.blow);
  }
  EXPECT_FALSE(scale(effort("1")).by_effort);
  EXPECT_FALSE(scale(effort("50"), "armature='.1'").by_effort);
}

// about its own axis no force at the end effector turns it
TEST_F(OneJoint, WithoutALeverNothingTouchesIt) {
  const std::vector<Scenario> all = generic_scenarios(rod("axis='0 0 1'"));
  EXPECT_EQ(all.size(), 6U);
  EXPECT_EQ(all.back().name, "chirp");
}

}  // namespace
}  // namespace tauext::test
