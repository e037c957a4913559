// SPDX-License-Identifier: Apache-2.0
#include "bench/study/study_runs.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <tuple>

#include "bench/roster/robots.h"
#include "bench/roster/threshold_file.h"
#include "bench/study/detection/calibration.h"
#include "bench/study/detection/detection_study.h"
#include "bench/study/moved_on.h"
#include "mjcf/plant/tree.h"
#include "mjcf/test/error_of.h"

namespace tauext::study::test {
namespace {

using tauext::test::error_of;
using Names = std::vector<std::string>;

TEST(StudyRuns, ARobotWithoutRunsIsToldWhichHaveThem) {
  EXPECT_EQ(error_of([] { touched_runs(&robot("testbed1")); }),
            "the detection study has no runs for testbed1; it has them for wallmobot3, "
            "wallmobot6, and for robots from files");
  EXPECT_EQ(touched_runs().robot, &robot("wallmobot3"));
}

TEST(StudyRuns, TakeSpecificationsAndRefuseWhatCannotBeBuilt) {
  const Robot& r = *touched_runs().robot;
  const Names tuned = {"mo2:bandwidth=50", "ekf"}, detectors = {"high_pass:w=60"};
  EXPECT_EQ(chosen_estimators(r, tuned), tuned);
  EXPECT_EQ(chosen_detectors(r, detectors), detectors);
  EXPECT_EQ(chosen_detectors(r, {}), r.detectors());
  const auto error = [&](const char* e) { return error_of([&] { chosen_estimators(r, {e}); }); };
  EXPECT_EQ(error("truth").find("unknown estimator 'truth'; known: inverse_dynamics"), 0u)
      << "a baseline would win every study";
  EXPECT_NE(error("mo2:width=50").find("there is no key 'width'; known: bandwidth"),
            std::string::npos);
  EXPECT_NE(error("mo2:bandwidth=-1").find("it must be"), std::string::npos);
  EXPECT_NE(error_of([&] { chosen_detectors(r, {"high_pass:w=x"}); }).find("not a number"),
            std::string::npos);
}

TEST(Calibration, ASpecificationThatWasTrainedHasItsOwnThresholds) {
  const auto trained = [](double x) { return Trained{Eigen::VectorXd::Constant(3, x), {}}; };
  ThresholdSet set{.robot = "wallmobot3"};
  set.by_estimator["mo1"] = {{"high_pass", trained(1)}, {"high_pass:w=60", trained(2)}};
  const Thresholds all{.sets = {set}};
  const auto of = [&](const std::string& name, const std::string& e, const std::string& d) {
    return trained_for(all, robot(name), 0, e, d);
  };
  EXPECT_EQ(of("wallmobot3", "mo1", "high_pass").at("high_pass").threshold[0], 1);
  EXPECT_EQ(of("wallmobot3", "mo1", "high_pass:w=60").at("high_pass").threshold[0], 2);
  EXPECT_TRUE(of("wallmobot3", "mo1", "").empty());
  EXPECT_TRUE(trained_for({}, robot("wallmobot3"), 0, "mo1", "high_pass").empty());  // no file
  const std::string behind_it = "behind this estimator it has those of high_pass, high_pass:w=60;";
  for (const auto& [robot, e, d, why] :
       {std::tuple{"wallmobot3", "mo1", "high_pass:w=90", behind_it},
        {"wallmobot3", "mo1", "cusum", behind_it},
        {"wallmobot3", "mo1:bandwidth=60", "high_pass", "there it has those behind mo1;"},
        {"testbed1", "mo1", "high_pass", "it is for wallmobot3;"}}) {
    EXPECT_NE(error_of([&, robot = robot, e = e, d = d] { of(robot, e, d); }).find(why),
              std::string::npos)
        << robot << e << d;
  }
}

TEST(Calibration, AClassifierHasTheThresholdsOfWhatItIsMadeOf) {
  const auto trained = [](double x) { return Trained{Eigen::VectorXd::Constant(3, x), {}}; };
  ThresholdSet set{.robot = "wallmobot3"};
  set.by_estimator["mo1"] = {{"pan_tompkins", trained(1)}, {"clamping", trained(2)}};
  set.by_estimator["mo2"] = {{"pan_tompkins", trained(1)}};
  const Thresholds all{.sets = {set}};
  const auto of = [&](const std::string& e) {
    return trained_for(all, robot("wallmobot3"), 0, e, "contact_classifier");
  };
  EXPECT_EQ(of("mo1").at("pan_tompkins").threshold[0], 1);
  EXPECT_EQ(of("mo1").at("clamping").threshold[0], 2);
  EXPECT_NE(error_of([&] { of("mo2"); }).find("contact_classifier (of pan_tompkins and clamping)"),
            std::string::npos);
  constexpr int kSamples = 2000;
  Trace still{.q = Eigen::MatrixXd::Zero(3, kSamples)};
  still.qd = still.tau = still.q;
  Output blow{still.q, std::vector<Status>(kSamples, Status::kOk), {}};
  for (int k = 0; k < kSamples; ++k) still.t.push_back(1e-3 * k);
  blow.tau_ext.middleCols(1000, 30).setConstant(200);
  const auto marks = [&](double threshold) {
    const DetectorSettings known{
        .thresholds = {{"pan_tompkins", trained(threshold)}, {"clamping", trained(1e9)}}};
    const auto said = robot("wallmobot3").detect("contact_classifier", still, blow, known);
    return std::any_of(said.begin(), said.end(), [](const Detection& d) { return d.mark; });
  };
  EXPECT_TRUE(marks(1));
  EXPECT_FALSE(marks(1e12));
}

TEST(Calibration, AClassifierAloneIsTrainedAsAmongOthers) {
  CalibrationOptions o{.conditions = {"known_150"}, .estimators = {"mo2"}, .runs = 2};
  const Thresholds all = calibrate(o);
  o.detectors = {"contact_classifier", "clamping"};
  const Thresholds alone = calibrate(o);
  for (const std::string d : {"contact_classifier", "clamping"}) {
    const auto of = trained_for(alone, robot("wallmobot3"), 0, "mo2", d);
    for (const auto& [part, trained] : trained_for(all, robot("wallmobot3"), 0, "mo2", d))
      EXPECT_EQ(of.at(part).threshold, trained.threshold) << part;
  }
  EXPECT_EQ(alone.sets.front().by_estimator.at("mo2").size(), 2);
}

// each plant's first run is MuJoCo's, too, or the study ends
TEST(DetectionStudy, HonestConditionsAreThoseOfAnyArm) {
  StudyOptions o;
  o.conditions = {"light", "typical", "hard", "hard_250hz"};
  o.estimators = {"mo2"};
  o.detectors = {"cusum"};
  o.blows = 8;
  o.brisk_pushes = o.clampings = 0;
  o.hours = 0.007;  // a run
  const std::vector<Cell> all = detection_study(o, {});
  ASSERT_EQ(all.size(), 4u);
  for (const Cell& c : all) {
    EXPECT_EQ(c.failed_runs, 0) << c.condition;
    EXPECT_GE(c.blows, 8) << c.condition;
    EXPECT_NEAR(c.hours(), 26. / 3600, 1e-5) << c.condition;
  }
  for (const char* name : {"wallmobot3", "bench/examples/arm6.xml"}) {
    const StudyRuns& runs = touched_runs(&robot(name));
    EXPECT_EQ(std::count(runs.quick.begin(), runs.quick.end(), "hard"), 0) << "only if asked for";
    const PlantKey known = plant_of(runs.conditions.front());
    const PlantKey hard = plant_of(condition(runs, "hard"));
    EXPECT_EQ(plant_of(condition(runs, "hard_250hz")), hard) << "the same run, seen less often";
    const Model model = runs.model(hard);
    const auto run = [&](const PlantKey& plant, std::uint64_t seed) {
      const Job job{plant, TouchKind::kSlowPush, seed};
      return std::move(simulated(runs, {&job, 1}, model).front());
    };
    const Trace slow = run(known, 1), brisk = run(hard, 1), training = run(hard, kTrainingSeed);
    EXPECT_GT(brisk.qd.cwiseAbs().maxCoeff(), 3 * slow.qd.cwiseAbs().maxCoeff());
    EXPECT_LT(brisk.qd.cwiseAbs().maxCoeff(), 3) << "[rad/s], springs and all";
    EXPECT_GT((brisk.motor_q - brisk.q).cwiseAbs().maxCoeff(), 1e-3);
    const auto rests = [](const Trace& t) {
      int count = 0;
      for (int k = 0; k < t.size(); ++k) count += t.qd.col(k).norm() < 2e-2;
      return static_cast<double>(count) / t.size();
    };
    EXPECT_GT(rests(brisk), 0.1) << "from place to place";
    EXPECT_LT(rests(training), 0.02) << "detectors are trained on other motions: sines,";
    EXPECT_GT(rests(run(hard, kTrainingSeed + 1)), 0.1) << "and moves of another kind";
  }
}

TEST(MovedOn, IsFromWhereTheMeetingBeganToWhereOurOwnModelSaysThePointIs) {
  const StudyRuns& runs = touched_runs(&robot("bench/examples/arm6.xml"));
  const Job job{plant_of(condition(runs, "hard")), TouchKind::kSlowPush, 1, 0};
  const Model model = runs.model(job.plant);
  const Trace truth = std::move(simulated(runs, {&job, 1}, model).front());
  std::vector<RegionTouch> touches = meetings_of(runs, job);
  for (RegionTouch& t : touches) t.at = {};  // the end effector
  const std::vector<double> moved = moved_on(touches, model, truth);
  const auto point = tree_of(model).point(kEndEffector);
  const auto arm = tree_model<6>(model);
  const auto at = [&](int k) { return arm.position(truth.q.col(k), point.joint, point.place); };
  int seen = 0;
  for (const RegionTouch& t : touches) {
    const int begin = static_cast<int>(std::ceil(t.begin * 1e3 - 1e-6));
    for (int k = begin; k < begin + 200; ++k, ++seen)
      ASSERT_NEAR(moved[static_cast<std::size_t>(k)], (at(k) - at(begin)).norm(), 1e-9) << k;
  }
  EXPECT_GT(seen, 1000);
  // a mark counts until kGrace after the sample behind the last force
  auto last = std::size_t(0);
  for (std::size_t k = 0; k < moved.size(); ++k) last = truth.contact_force[k] > 0 ? k : last;
  EXPECT_GT(moved.at(last + 201), 0);
  EXPECT_EQ(moved.at(last + 203), 0);
  EXPECT_EQ(moved.front(), 0);
  EXPECT_GT(*std::max_element(moved.begin(), moved.end()), 1e-2);
}

}  // namespace
}  // namespace tauext::study::test
