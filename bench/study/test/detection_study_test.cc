// SPDX-License-Identifier: Apache-2.0
#include "bench/study/detection/detection_study.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "bench/roster/robots.h"
#include "bench/roster/threshold_file.h"
#include "bench/study/detection/calibration.h"
#include "bench/study/detection/detection_report.h"
#include "bench/study/study_runs.h"
#include "mjcf/record.h"
#include "mjcf/scenarios/touch.h"
#include "mjcf/test/error_of.h"

namespace tauext::study::test {
namespace {

using tauext::test::error_of;

StudyOptions small() {
  StudyOptions o;
  o.conditions = {"known_150"};
  o.estimators = {"mo1"};
  o.detectors = {"pan_tompkins", "high_pass"};
  o.blows = 16;
  o.brisk_pushes = 8;
  o.clampings = 3;
  o.hours = 0.01;
  o.threads = 1;
  return o;
}

const std::vector<Cell>& cells() {
  static const std::vector<Cell> all = detection_study(small(), {});
  return all;
}

TEST(DetectionStudy, TriesAtLeastWhatItWasAskedFor) {
  ASSERT_EQ(cells().size(), 2u);
  for (const Cell& c : cells()) {
    EXPECT_EQ(c.estimator, "mo1");
    EXPECT_GE(c.blows, 16);
    EXPECT_GE(c.brisk, 8);
    EXPECT_GE(c.clampings, 3);
    EXPECT_GE(c.hours(), 0.01);
    EXPECT_EQ(c.failed_runs, 0);
  }
}

StudyOptions of_regions() {
  StudyOptions o = small();
  o.blows = o.brisk_pushes = o.clampings = 0;
  o.hours = 0;
  o.regions = 4;
  return o;
}

TEST(DetectionStudy, MeetsEachKindOfRegion) {
  const std::vector<Cell> all = detection_study(of_regions(), {});
  ASSERT_EQ(all.size(), 2u);
  for (const Cell& c : all) {
    EXPECT_EQ(c.failed_runs, 0);
    EXPECT_EQ(c.blows, 0);
    ASSERT_EQ(c.regions.size(), region_classes().size());
    for (std::size_t i = 0; i < c.regions.size(); ++i) {
      const RegionCount& r = c.regions[i];
      const RegionClass& of = region_classes()[i];
      EXPECT_GE(r.touches, 4) << of.name;
      ASSERT_EQ(r.peaks.size(), static_cast<std::size_t>(r.touches));
      ASSERT_EQ(r.until_found.size(), r.peaks.size());
      EXPECT_EQ(r.delays.size(), static_cast<std::size_t>(r.found));
      EXPECT_LE(r.until_found.back(), r.peaks.back() + 1e-12);
      // of a speed that is a share of the limit, the peak is: the arm gives way while it is pushed
      if (of.share_of_limit > 0) {
        EXPECT_NEAR(r.peaks.front(), of.share_of_limit, 0.2 * of.share_of_limit) << of.name;
        EXPECT_NEAR(r.peaks.back(), of.share_of_limit, 0.2 * of.share_of_limit) << of.name;
      }
      if (of.meeting == Meeting::kClamped) {
        EXPECT_NEAR(r.peaks.front(), 1, 1e-9) << of.name;
      }
    }
  }
  const auto json = nlohmann::json::parse(study_json(touched_runs(), all, {}));
  const auto& hand = json.at("cells")[0].at("regions")[0];
  EXPECT_EQ(hand.at("class"), "hand_0.10");
  EXPECT_EQ(hand.at("limit_N"), 280);
  EXPECT_EQ(hand.at("touches"), all[0].regions[0].touches);
  EXPECT_LE(hand.at("moved_p50_m"), hand.at("moved_p95_m"));
  EXPECT_NE(format_study(touched_runs(), all, TableFormat::kText).find("exceeded"),
            std::string::npos);
}

TEST(DetectionStudy, OfRegionsCountsTheFirstMarkAndWhatWasPressedUntilThen) {
  const RegionClass& of = region_classes()[0];  // 280 N
  std::vector<double> force(3000, 0.);
  for (int k = 0; k < 40; ++k) force[static_cast<std::size_t>(1001 + k)] = 10. * k;  // to 390 N
  RegionTouch touch{.begin = 1};
  Answers answers;
  answers.marks = {{0.5, Contact::kCollision}, {1.011, Contact::kCollision}, {1.02, {}}};
  answers.rises.resize(kLevels.size());
  answers.rises.front() = {0.9};
  answers.rises[kOwnLevel] = {0.5, 1.011};
  RegionCount r;
  std::vector<double> moved(3000, 0.);
  moved[1011] = 2e-3;
  count_regions(of, answers, {touch}, force, moved, r);
  EXPECT_EQ(r.found, 1);
  EXPECT_EQ(r.moved, std::vector{2e-3});
  EXPECT_NEAR(r.delays.at(0), 0.011, 1e-12);
  EXPECT_NEAR(r.until_found.at(0), 100 / 280., 0.5001e-5);
  EXPECT_NEAR(r.peaks.at(0), 390 / 280., 0.5001e-5);
  EXPECT_EQ(r.exceeded(), 0);
  EXPECT_EQ(r.found_at.front(), 0) << "its rise was before the contact";
  EXPECT_EQ(r.found_at[kOwnLevel], 1);
  EXPECT_EQ(r.found_at.back(), 0);
  answers.marks = {{1.3, Contact::kCollision}};  // 0.26 s after the contact
  count_regions(of, answers, {touch}, force, moved, r);
  EXPECT_EQ(r.found, 1);
  EXPECT_EQ(r.touches, 2);
  EXPECT_EQ(r.exceeded(), 0.5);
}

TEST(DetectionStudy, DoesNotDependOnTheNumberOfThreads) {
  StudyOptions o = small();
  o.threads = 3;
  const std::vector<Cell> other = detection_study(o, {});
  ASSERT_EQ(other.size(), cells().size());
  EXPECT_EQ(study_json(touched_runs(), other, {}), study_json(touched_runs(), cells(), {}));
  for (std::size_t i = 0; i < other.size(); ++i) EXPECT_EQ(other[i].delays, cells()[i].delays);
}

TEST(DetectionStudy, FindsEveryBlowWithAnExactModelAndGoodSensors) {
  const Cell& c = cells()[0];
  ASSERT_EQ(c.detector, "pan_tompkins");
  EXPECT_EQ(c.detected, c.blows);
  EXPECT_EQ(c.stray, 0);
  ASSERT_EQ(static_cast<int>(c.delays.size()), c.blows);
  EXPECT_GT(c.delays.front(), 0);
  EXPECT_LT(c.delays.back(), 0.03);
}

TEST(DetectionStudy, HigherThresholdsMarkLess) {
  const Cell& c = cells()[1];
  ASSERT_EQ(c.detector, "high_pass");
  // below some level pushes and blows run into one another
  for (std::size_t i = kOwnLevel; i < kLevels.size(); ++i) {
    EXPECT_LE(c.detected_at[i], c.detected_at[i - 1]);
    EXPECT_LE(c.alarms_at[i], c.alarms_at[i - 1]);
  }
  EXPECT_EQ(c.detected_at[kOwnLevel], c.detected) << "level 1 is the detector itself";
  EXPECT_EQ(c.detected_at.back(), 0);
}

TEST(DetectionStudy, ShowsADetectorThatIsInAlarmAllTheTime) {
  // it marks once, before anything is scored, and never again: no false alarm, and blind
  ThresholdSet set{.robot = "wallmobot3", .velocity_noise = 1e-4, .by_estimator = {}};
  set.by_estimator["mo1"]["threshold"] = {Eigen::VectorXd::Constant(3, 1e-9), {}};
  StudyOptions o = small();
  o.detectors = {"threshold"};
  o.brisk_pushes = o.clampings = 0;
  const Cell c = detection_study(o, {.trained_on = "", .margin = 1, .sets = {set}}).front();
  EXPECT_EQ(c.alarms, 0);
  EXPECT_EQ(c.detected, 0);
  EXPECT_EQ(c.alarmed_samples, c.quiet_samples);
  EXPECT_EQ(cells()[0].alarmed_samples, 0) << "and one that is not";
}

TEST(DetectionStudy, ASpecificationOfTheRostersOwnValueIsTheSameEstimator) {
  StudyOptions o = small();
  o.estimators = {"mo1", "mo1:bandwidth=30", "mo1:bandwidth=90"};  // 30 is the roster's
  o.detectors = {"high_pass"};
  o.brisk_pushes = o.clampings = 0;
  const std::vector<Cell> both = detection_study(o, {});
  ASSERT_EQ(both.size(), 3u);
  EXPECT_EQ(both[1].estimator, "mo1:bandwidth=30");
  EXPECT_EQ(both[1].delays, both[0].delays);
  EXPECT_EQ(both[1].detected_at, both[0].detected_at);
  EXPECT_NE(both[2].delays, both[0].delays) << "and another one is another estimator";
}

TEST(Calibration, TrainsASpecificationForItself) {
  CalibrationOptions o;
  o.conditions = {"known_0"};
  o.estimators = {"mo1", "mo1:bandwidth=30"};
  o.detectors = {"high_pass", "high_pass:w=100"};
  o.runs = 1;
  const ThresholdSet set = calibrate(o).sets.front();
  const DetectorThresholds& named = set.by_estimator.at("mo1");
  EXPECT_EQ(named.size(), 2u) << "no others";
  EXPECT_EQ(named.at("high_pass").threshold,
            set.by_estimator.at("mo1:bandwidth=30").at("high_pass").threshold)
      << "the roster's own bandwidth";
  // a filter that lets less pass has less to be above
  const Eigen::VectorXd difference =
      named.at("high_pass").threshold - named.at("high_pass:w=100").threshold;
  EXPECT_GT(difference.minCoeff(), 0);
}

// of wallmobot3 at rest, with so much noise of its loadcells [N m]
FreeRecording at_rest(const std::string& name, double noise, std::uint64_t seed) {
  Sensors sensors{.velocity_noise = 1e-4, .loadcell = {.noise = noise}};
  sensors.seed = seed;
  const Scenario& s = scenario_of(robot("wallmobot3"), "free");
  Trace t = record(robot("wallmobot3").load_for(s), s, sensors);
  for (double& x : t.t) x += 100;  // as clocks of logs are
  t.tau_ext.resize(0, 0);
  t.contact.clear();
  return {name, std::move(t)};
}

TEST(Calibration, OnRecordingsTakesTheLargestAndTriesItOnTheOthers) {
  CalibrationOptions o;
  o.estimators = {"mo1"};
  o.detectors = {"threshold"};
  const Robot& r = robot("wallmobot3");
  const FreeRecording quiet = at_rest("quiet.csv", 0.1, 1), loud = at_rest("loud.csv", 50, 2);
  std::vector<HeldOut> none, three;
  const auto of = [](const Thresholds& t) {
    return t.sets.at(0).by_estimator.at("mo1").at("threshold").threshold;
  };
  const Thresholds of_quiet = calibrate_on(r, {quiet}, o, none);
  EXPECT_TRUE(none.empty()) << "nobody to try it on";
  const Thresholds all = calibrate_on(r, {quiet, loud, at_rest("as_quiet.csv", 0.1, 3)}, o, three);
  EXPECT_GT((of(all) - 2 * of(of_quiet)).minCoeff(), 0);
  EXPECT_EQ(of(all), of(calibrate_on(r, {loud}, o, none)));
  ASSERT_FALSE(three.empty());
  for (const HeldOut& h : three) {
    EXPECT_EQ(h.recordings, 3);
    EXPECT_EQ(h.alarms, 1) << h.detector << ": the loud one, by those of the quiet ones";
  }
  EXPECT_NE(all.trained_on.find("quiet.csv, loud.csv, as_quiet.csv"), std::string::npos);
  EXPECT_EQ(trained_for(all, robot("wallmobot3"), 0, "mo1", "threshold").at("threshold").threshold,
            of(all));
}

TEST(Calibration, OnRecordingsAStrayFirstRowChangesNothing) {
  CalibrationOptions o;
  o.estimators = {"mo1", "mo2"};
  o.detectors = {"threshold"};
  std::vector<HeldOut> none;
  const FreeRecording good = at_rest("a.csv", 1, 1);
  const Thresholds of_good = calibrate_on(robot("wallmobot3"), {good}, o, none);
  for (const double stray : {-36000., -1., 36000.}) {
    FreeRecording r = good;
    r.trace.t.front() += stray;
    const Thresholds t = calibrate_on(robot("wallmobot3"), {r}, o, none);
    EXPECT_EQ(t.trained_on, of_good.trained_on);
    for (const auto& [e, by_detector] : of_good.sets.at(0).by_estimator) {
      for (const auto& [d, trained] : by_detector)
        EXPECT_TRUE(
            t.sets.at(0).by_estimator.at(e).at(d).threshold.isApprox(trained.threshold, 1e-6))
            << e << " " << d << " " << stray;
    }
  }
}

TEST(Calibration, OnRecordingsRefusesContactsAndWhatIsTooShort) {
  const auto error = [](FreeRecording recording, auto&& change) {
    change(recording.trace);
    std::vector<HeldOut> held_out;
    return error_of(
        [&] { calibrate_on(robot("wallmobot3"), {recording}, {.estimators = {"mo1"}}, held_out); });
  };
  const FreeRecording good = at_rest("a.csv", 1, 1);
  EXPECT_NE(error(good, [](Trace& t) { t.contact.assign(t.t.size(), 0), t.contact[500] = 1; })
                .find("a.csv: something touches the arm at 100.5 s"),
            std::string::npos);
  EXPECT_NE(error(good, [](Trace& t) { t.t.resize(3000); }).find("a.csv: 3 s long; 8 s are needed"),
            std::string::npos);
  EXPECT_NE(error(good, [](Trace& t) { t.q = t.q.topRows(2).eval(); })
                .find("a.csv: wallmobot3 has 3 joints, the samples have 2"),
            std::string::npos);
}

TEST(DetectionStudy, TestsOnSeedsThatNoTrainingKnows) {
  StudyOptions o = small();
  o.first_seed = kTrainingSeed - 1;
  EXPECT_NE(error_of([&] { detection_study(o, {}); }).find("a test would know its training"),
            std::string::npos);
}

TEST(DetectionStudy, UnknownNamesListTheKnownOnes) {
  StudyOptions o = small();
  o.conditions = {"underwater"};
  EXPECT_NE(error_of([&] { detection_study(o, {}); })
                .find("unknown condition 'underwater'; known: "
                      "known_0, known_50"),
            std::string::npos);
  o = small();
  o.robot = &robot("testbed1");
  EXPECT_NE(error_of([&] { detection_study(o, {}); }).find("no runs for testbed1"),
            std::string::npos);
  o = small();
  o.estimators = {"oracle"};
  EXPECT_NE(error_of([&] { detection_study(o, {}); }).find("unknown estimator 'oracle'"),
            std::string::npos);
  EXPECT_NE(error_of([] { calibrate({.margin = 0.9}); }).find("a margin of 0.9 is below 1"),
            std::string::npos);
}

TEST(DetectionReport, HoldsEveryCellAsJsonAndAsALine) {
  const auto json = nlohmann::json::parse(study_json(touched_runs(), cells(), {}));
  ASSERT_EQ(json["cells"].size(), cells().size());
  EXPECT_EQ(json["cells"][0]["collisions"], cells()[0].blows);
  EXPECT_EQ(json["cells"][0]["roc"].size(), kLevels.size());
  EXPECT_EQ(json["conditions"]["known_150"]["panel_kg"], 150);
  const std::string text = format_study(touched_runs(), cells());
  for (const char* row : {"\nmo1+pan_tompkins ", "\nmo1+high_pass "}) {
    EXPECT_NE(text.find(row), std::string::npos) << text;
  }
  const auto table =
      nlohmann::json::parse(format_study(touched_runs(), cells(), TableFormat::kJson));
  ASSERT_EQ(table.size(), cells().size());
  EXPECT_EQ(table[0]["condition"], "known_150");
  EXPECT_EQ(table[0]["recall_percent"], 100);
}

}  // namespace
}  // namespace tauext::study::test
