// SPDX-License-Identifier: Apache-2.0
#include "bench/calibrate/arm_calibration.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>

#include "bench/calibrate/robot_file_writer.h"
#include "bench/calibrate/weighing.h"
#include "mjcf/import/robot_file.h"
#include "mjcf/plant/simulated.h"
#include "mjcf/record.h"

namespace tauext::test {
namespace {

constexpr const char* kArm6 = "bench/examples/arm6.xml";

// what its file does not know of one of its joints
MeasuredJoint some_joint(int i) {
  MeasuredJoint j;
  j.armature = 0.05 + 0.02 * i;
  j.coulomb = 2 - 0.3 * i;
  j.viscous = 3 - 0.4 * i;
  j.viscous_skew = 0.1 * i;
  j.offset = 0.4 - 0.15 * i;
  return j;
}

const std::vector<std::string>& joint_names() {
  static const std::vector<std::string> all = {"shoulder_pan", "shoulder_lift", "elbow",
                                               "wrist1",       "wrist2",        "wrist3"};
  return all;
}

MeasuredTerms some_terms() {
  MeasuredTerms terms;
  for (int i = 0; i < 6; ++i)
    terms.joints[joint_names()[static_cast<std::size_t>(i)]] = some_joint(i);
  return terms;
}

MeasuredTerms with_payload(double mass, const Eigen::Vector3d& c) {
  MeasuredTerms terms = some_terms();
  terms.payload = {"wrist3", mass, {c[0], c[1], c[2]}};
  return terms;
}

Model arm6(const MeasuredTerms& terms) {
  return simulated(load_mjcf(kArm6, {"", terms}));
}

// joints that swing together, each at frequencies of its own
Scenario swing(double duration) {
  Scenario s = quiet();
  s.duration = duration;
  s.start_on_reference = true;
  s.reference = [](double t, int i) {
    const Reference slow = sine_motion(0.7, 0.61 + 0.17 * i, t),
                    fast = sine_motion(0.25, 1.9 + 0.31 * i, t + i);
    const double home[] = {0, -0.8, 0.9, 0.4, 0.5, 0};
    return Reference{home[i] + slow.q + fast.q, slow.qd + fast.qd, slow.qdd + fast.qdd};
  };
  return s;
}

Sensors noisy(double noise, std::uint64_t seed) {
  Sensors sensors;
  sensors.velocity_noise = noise;
  sensors.loadcell_noise = 20 * noise;
  sensors.seed = seed;
  return sensors;
}

Trace swinging(const Model& arm, double duration, double noise, std::uint64_t seed = 1) {
  return record(arm, swing(duration), noisy(noise, seed));
}

const CalibratedTerm& term(const CalibratedJoint& joint, const std::string& name) {
  return *std::find_if(joint.terms.begin(), joint.terms.end(),
                       [&](const CalibratedTerm& t) { return t.name == name; });
}

double truth(int joint, const std::string& name) {
  const MeasuredJoint j = some_joint(joint);
  return name == "armature"       ? *j.armature
         : name == "coulomb"      ? *j.coulomb
         : name == "viscous"      ? *j.viscous
         : name == "viscous_skew" ? *j.viscous_skew
                                  : *j.offset;
}

const CalibrateOptions kAll;

TEST(ArmCalibration, FindsWhatASimulatedArmHas) {
  const Trace log = swinging(arm6(some_terms()), 30, 0);
  const auto joints = calibrate_arm(tree_of(load_mjcf(kArm6)), {log}, kAll);
  ASSERT_EQ(joints.size(), 6u);
  for (int i = 0; i < 6; ++i) {
    const CalibratedJoint& j = joints[static_cast<std::size_t>(i)];
    EXPECT_EQ(j.name, joint_names()[static_cast<std::size_t>(i)]);
    for (const CalibratedTerm& t : j.terms)
      EXPECT_NEAR(t.value, truth(i, t.name), 0.01 * (0.1 + std::abs(truth(i, t.name))))
          << j.name << " " << t.name;
    EXPECT_LT(j.after, 0.01) << j.name;
    EXPECT_GT(j.before, 0.3) << j.name;
  }
}

TEST(ArmCalibration, ItsErrorsCoverTheTruth) {
  int within = 0, all = 0;
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const Trace log = swinging(arm6(some_terms()), 30, 3e-3, seed);
    for (const CalibratedJoint& j : calibrate_arm(tree_of(load_mjcf(kArm6)), {log}, kAll)) {
      const int i = static_cast<int>(std::find(joint_names().begin(), joint_names().end(), j.name) -
                                     joint_names().begin());
      for (const CalibratedTerm& t : j.terms) {
        EXPECT_LT(t.error, 0.1 + 0.1 * std::abs(t.value)) << j.name << " " << t.name;
        ++all;
        within += std::abs(t.value - truth(i, t.name)) < 3 * t.error;
      }
      EXPECT_NEAR(j.held_out, j.after, 0.1 * j.after) << j.name;
    }
  }
  EXPECT_GE(within, all * 95 / 100) << all;
}

// what a plain URDF leaves out of an arm of 30 kg: rotors, and wrists that rub by 2 N m
TEST(ArmCalibration, ItsErrorsCoverTheTruthWhereTheSpeedIsNoisyAndRotorsAreUnknown) {
  const double armature[] = {1.2, 1.1, 0.5, 0.12, 0.1, 0.08}, coulomb[] = {9, 8, 5, 2, 2, 2},
               viscous[] = {12, 11, 6, 2, 1.5, 1.2};
  MeasuredTerms terms;
  for (std::size_t i = 0; i < 6; ++i) {
    MeasuredJoint& j = terms.joints[joint_names()[i]];
    j.armature = armature[i], j.coulomb = coulomb[i], j.viscous = viscous[i];
    j.viscous_skew = j.offset = 0;
  }
  const Trace truth = record(arm6(terms), swing(40));
  const ArmTree file = tree_of(load_mjcf(kArm6));
  constexpr int kRuns = 20;
  for (const double noise : {1e-3, 3e-3}) {
    std::map<std::string, Eigen::Array2d> all;  // of a parameter: within 3 errors, and squares
    for (std::uint64_t seed = 1; seed <= kRuns; ++seed)
      for (const CalibratedJoint& j : calibrate_arm(file, {measure(truth, noisy(noise, seed))})) {
        const MeasuredJoint& is = terms.joints[j.name];
        for (const CalibratedTerm& t : j.terms) {
          const double right = t.name == "armature"  ? *is.armature
                               : t.name == "coulomb" ? *is.coulomb
                               : t.name == "viscous" ? *is.viscous
                                                     : 0;
          const double z = (t.value - right) / t.error;
          auto& sum = all.try_emplace(j.name + " " + t.name, Eigen::Array2d::Zero()).first->second;
          sum += Eigen::Array2d(std::abs(z) <= 3, z * z) / kRuns;
        }
      }
    for (const auto& [name, z] : all) {
      EXPECT_GE(z[0], 0.95) << noise << " " << name << ", rms of its z " << std::sqrt(z[1]);
    }
  }
}

TEST(ArmCalibration, CurrentsGiveTheGainsOfDrives) {
  Trace log = swinging(arm6(some_terms()), 30, 1e-3);
  Eigen::VectorXd gain(6);
  gain << 12, 11, 9, 8, -10, 7;
  log.tau = gain.cwiseInverse().asDiagonal() * log.tau;
  log.tau_is_current = true;
  const ArmTree arm = tree_of(load_mjcf(kArm6));
  try {
    calibrate_arm(arm, {log}, kAll);
    FAIL() << "the last joint carries nothing";
  } catch (const std::invalid_argument& e) {
    EXPECT_NE(std::string(e.what()).find("the gain of its drive cannot be seen"), std::string::npos)
        << e.what();
  }
  const ArmTree heavy = tree_of(load_mjcf(kArm6, {"", with_payload(4, {0, 0.1, 0.3})}));
  log = swinging(arm6(with_payload(4, {0, 0.1, 0.3})), 30, 1e-3);
  log.tau = gain.cwiseInverse().asDiagonal() * log.tau;
  log.tau_is_current = true;
  const auto joints = calibrate_arm(heavy, {log}, kAll);
  for (int i = 0; i < 6; ++i) {
    const CalibratedJoint& j = joints[static_cast<std::size_t>(i)];
    EXPECT_NEAR(j.gain, gain[i], std::max(4 * j.gain_error, 1e-3)) << j.name;
    EXPECT_LT(j.gain_error, 0.1) << j.name;
    EXPECT_NEAR(term(j, "coulomb").value, *some_joint(i).coulomb, 0.05) << j.name;
  }
}

TEST(ArmCalibration, AScaleIsSeenByWeightAlone) {
  Trace log = swinging(arm6(some_terms()), 30, 1e-3);
  log.tau /= 1.1;  // a sensor that reads too little
  const auto joints = calibrate_arm(tree_of(load_mjcf(kArm6)), {log});
  EXPECT_NEAR(joints[1].scale, 1.1, 0.01);
  EXPECT_LT(joints[1].scale_error, 0.01);
  EXPECT_EQ(joints[5].scale, 0);  // which carries nothing
}

TEST(ArmCalibration, SaysWhatIsMissing) {
  const Trace log = swinging(arm6(some_terms()), 30, 1e-4);
  const auto joints = calibrate_arm(tree_of(load_mjcf(kArm6)), {log},
                                    {{"armature", "coulomb", "viscous", "offset"}, {}});
  ASSERT_FALSE(joints[4].missing.empty());
  EXPECT_NE(joints[4].missing[0].name.find("viscous_skew"), std::string::npos);
}

// what is not asked for stays as the file has it
TEST(ArmCalibration, FindsOneThingAloneWhereTheFileKnowsTheOthers) {
  const Trace log = swinging(arm6(some_terms()), 30, 0);
  MeasuredTerms known = some_terms();
  for (auto& [name, joint] : known.joints) joint.armature = 1.2 * *joint.armature;
  const auto armature =
      calibrate_arm(tree_of(load_mjcf(kArm6, {"", known})), {log}, {{"armature"}, {}});
  known = some_terms();
  for (auto& [name, joint] : known.joints) joint.coulomb = joint.viscous = joint.offset = 9;
  const auto friction = calibrate_arm(tree_of(load_mjcf(kArm6, {"", known})), {log},
                                      {{"coulomb", "viscous", "viscous_skew", "offset"}, {}});
  for (std::size_t i = 0; i < 6; ++i) {
    const int joint = static_cast<int>(i);
    EXPECT_NEAR(armature[i].terms[0].value, truth(joint, "armature"), 2e-3);
    for (const CalibratedTerm& t : friction[i].terms)
      EXPECT_NEAR(t.value, truth(joint, t.name), 0.02) << t.name;
  }
}

TEST(ArmCalibration, RefusesWhatItCannotTell) {
  const ArmTree arm = tree_of(load_mjcf(kArm6));
  const auto error_of = [&](const ArmTree& a, const std::vector<Trace>& logs,
                            const CalibrateOptions& o) -> std::string {
    try {
      calibrate_arm(a, logs, o);
    } catch (const std::invalid_argument& e) {
      return e.what();
    }
    return "nothing is wrong";
  };
  Trace log = swinging(arm6(some_terms()), 3, 0);
  EXPECT_NE(error_of(arm, {log}, {{"magic"}, {}}).find("unknown term 'magic'"), std::string::npos);
  EXPECT_NE(error_of(arm, {}, {}).find("no recording"), std::string::npos);
  log.contact.assign(static_cast<std::size_t>(log.size()), 1);
  EXPECT_NE(error_of(arm, {log}, {}).find("joint 1 'shoulder_pan': 0 usable windows"),
            std::string::npos);
  EXPECT_NE(error_of(tree_of(load_robot("wallmobot3")), {log}, {}).find("mix its joints"),
            std::string::npos);
}

bool doubts(const std::vector<CalibratedJoint>& joints, const std::string& why) {
  return std::any_of(joints.begin(), joints.end(), [&](const CalibratedJoint& j) {
    return std::any_of(j.doubts.begin(), j.doubts.end(), [&](const std::string& words) {
      return words.find(why) != std::string::npos;
    });
  });
}

TEST(ArmCalibration, DoubtsRecordingsThatCannotBeOfTheArm) {
  const ArmTree arm = tree_of(load_mjcf(kArm6));
  const Trace good = swinging(arm6(some_terms()), 30, 1e-3);
  Trace degrees = good, reversed = good, swapped = good, currents = good, milli = good;
  degrees.q *= 180 / M_PI, degrees.qd *= 180 / M_PI;
  reversed.tau *= -1;
  for (Eigen::MatrixXd* x : {&swapped.q, &swapped.qd, &swapped.tau}) x->row(1).swap(x->row(2));
  currents.tau /= 10;
  milli.tau *= 1000;
  for (const auto& [log, why] :
       {std::pair(&degrees, "more than is explained"),
        std::pair(&reversed, "is the sign of its torque or current right?"),
        std::pair(&swapped, "its torque fits its masses by a factor of"),
        std::pair(&currents, "its torque fits its masses by a factor of 10"),
        std::pair(&milli, "N m were measured: are they N m?")})
    EXPECT_TRUE(doubts(calibrate_arm(arm, {*log}), why)) << why;
  EXPECT_FALSE(doubts(calibrate_arm(arm, {good}), ""));
}

TEST(Weighing, DoubtsAPayloadOfLessThanNothing) {
  const ArmTree arm = tree_of(load_mjcf(kArm6, {"", some_terms()}));
  const Trace loaded = swinging(arm6(with_payload(1.7, {0.03, 0.12, -0.02})), 30, 1e-3),
              empty = swinging(arm6(some_terms()), 30, 1e-3, 2);
  EXPECT_EQ(doubt(weigh(arm, {loaded}, {empty})), "");
  const std::string swapped = doubt(weigh(arm, {empty}, {loaded}));
  EXPECT_NE(swapped.find("less than nothing: are the recordings with it behind --weigh"),
            std::string::npos)
      << swapped;
}

TEST(Weighing, FindsMassAndCenter) {
  const ArmTree arm = tree_of(load_mjcf(kArm6, {"", some_terms()}));
  const Eigen::Vector3d c(0.03, 0.12, -0.02);
  const Trace loaded = swinging(arm6(with_payload(1.7, c)), 30, 1e-3),
              empty = swinging(arm6(some_terms()), 30, 1e-3, 2);
  const Weighing w = weigh(arm, {loaded}, {empty});
  EXPECT_EQ(w.body, "wrist3");
  EXPECT_NEAR(w.payload.mass, 1.7, 3 * w.payload.mass_error + 1e-3);  // it is no point
  EXPECT_LT(w.payload.mass_error, 0.02);
  EXPECT_NEAR(w.empty.mass, 0, 3 * w.empty.mass_error);
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(w.center[i], c[i], 3 * w.center_error[i] + 1e-3) << i;
    EXPECT_LT(w.center_error[i], 0.01) << i;
  }
}

TEST(RobotFile, WhatWasFoundIsWhatIsRead) {
  const std::string path =
      (std::filesystem::temp_directory_path() / "tauext_written_robot.json").string();
  const Trace log = swinging(arm6(some_terms()), 10, 0);
  const auto joints = calibrate_arm(tree_of(load_mjcf(kArm6)), {log}, kAll);
  Weighing w;
  w.body = "wrist3";
  w.payload.mass = 1.5;
  w.center = {0.01, 0.02, 0.03};
  std::ofstream(path) << robot_file_text({kArm6, "", joints, &w, {"log.csv"}}, path);
  const ArmTree read = tree_of(load_mjcf(path)), arm = tree_of(load_mjcf(kArm6));
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_NEAR(read.joints[i].dry, term(joints[i], "coulomb").value, 1e-5);
    EXPECT_NEAR(read.joints[i].viscous_skew, term(joints[i], "viscous_skew").value, 1e-5);
    EXPECT_NEAR(read.joints[i].offset, term(joints[i], "offset").value, 1e-5);
  }
  EXPECT_NEAR(read.joints[5].mass, arm.joints[5].mass + 1.5, 1e-9);
  std::filesystem::remove(path);
}

}  // namespace
}  // namespace tauext::test
