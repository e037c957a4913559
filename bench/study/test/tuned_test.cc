// SPDX-License-Identifier: Apache-2.0
#include "bench/study/detection/tuned.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "bench/roster/robots.h"
#include "bench/roster/threshold_file.h"
#include "bench/study/detection/calibration.h"
#include "bench/study/detection/detection_study.h"
#include "mjcf/test/error_of.h"

namespace tauext::study::test {
namespace {

using tauext::test::error_of;

Trained all(double threshold) {
  return {Eigen::VectorXd::Constant(3, threshold), {}};
}

TunedStudy of(const std::string& condition, const std::string& estimator,
              const std::string& detector, double threshold) {
  ThresholdSet set{.robot = "wallmobot3", .condition = condition};
  for (const std::string& part : robot("wallmobot3").trained_parts(detector))
    set.by_estimator[estimator][part] = all(threshold);
  TunedRow row{"wallmobot3", "", condition, estimator, detector, "mo2+high_pass"};
  row.recall = 0.5, row.recall_before = 0.25, row.evaluations = 24, row.at_ends = {"w"};
  return {
      {.trained_on = condition, .margin = 1.1, .sets = {set}}, {row}, "tauext-tune " + condition};
}

TEST(Tuned, AFileHoldsPairsAndThresholdsOfConditions) {
  const std::string path = std::filesystem::temp_directory_path() / "tuned_test.json";
  TunedStudy t = of("hard", "mo2:bandwidth=50", "high_pass:w=40", 7);
  append(of("hard", "mo2:bandwidth=60", "contact_classifier:collision.stride=3", 8), t);
  append(of("light", "mo2:bandwidth=50", "high_pass:w=40", 9), t);
  ASSERT_EQ(t.thresholds.sets.size(), 2u) << "one for each condition";
  write_tuned(t, path);
  const TunedStudy back = read_tuned(path);
  ASSERT_EQ(back.rows.size(), 3u);
  EXPECT_EQ(back.rows[1].detector, "contact_classifier:collision.stride=3");
  EXPECT_EQ(back.rows[0].recall_before, 0.25);
  EXPECT_EQ(back.rows[0].at_ends, std::vector<std::string>{"w"});
  EXPECT_EQ(back.made_by, "tauext-tune hard; tauext-tune light");
  const auto threshold = [&](const char* condition, const char* e, const char* d,
                             const char* part) {
    return trained_for(back.thresholds, robot("wallmobot3"), 0, e, d, condition)
        .at(part)
        .threshold[0];
  };
  EXPECT_EQ(threshold("hard", "mo2:bandwidth=50", "high_pass:w=40", "high_pass"), 7);
  EXPECT_EQ(threshold("light", "mo2:bandwidth=50", "high_pass:w=40", "high_pass"), 9);
  for (const char* part : {"pan_tompkins", "clamping"})
    EXPECT_EQ(threshold("hard", "mo2:bandwidth=60", "contact_classifier:collision.stride=3", part),
              8);
  // thresholds for one condition are for no other
  for (const char* condition : {"", "typical"})
    EXPECT_NE(error_of([&] {
                trained_for(back.thresholds, robot("wallmobot3"), 0, "mo2:bandwidth=50",
                            "high_pass:w=40", condition);
              }).find("it is for wallmobot3 in hard, wallmobot3 in light;"),
              std::string::npos);
  std::filesystem::remove(path);
}

TEST(Tuned, AStudyTriesThesePairsAndNoOthers) {
  TunedStudy t = of("hard", "mo2:bandwidth=50", "high_pass:w=40", 7);
  append(of("hard", "mo1", "cusum", 8), t);
  StudyOptions o;
  o.conditions = {"hard"};
  o.tuned = t.rows;
  o.blows = 1;
  const DetectionStudy both(o, t.thresholds);
  ASSERT_EQ(both.cells().size(), 2u);
  EXPECT_EQ(both.cells()[1].estimator, "mo2:bandwidth=50");
  o.estimators = {"mo1"};
  EXPECT_EQ(DetectionStudy(o, t.thresholds).cells().at(0).detector, "cusum");
  o.estimators = {"ekf"};
  EXPECT_NE(error_of([&] { DetectionStudy(o, t.thresholds); }).find("was tuned for hard"),
            std::string::npos);
}

TEST(Calibration, OfAConditionThatTrainsItselfIsForItAlone) {
  CalibrationOptions o;
  o.pairs = {{"mo1", "high_pass"}, {"mo2", "contact_classifier:collision.stride=3"}};
  o.runs = 1;
  const Thresholds t = calibrate_for({"light"}, o);
  ASSERT_EQ(t.sets.size(), 1u);
  EXPECT_EQ(t.sets[0].condition, "light");
  ASSERT_EQ(t.sets[0].by_estimator.size(), 2u);
  EXPECT_EQ(t.sets[0].by_estimator.at("mo1").size(), 1u) << "that pair alone";
  EXPECT_TRUE(t.sets[0].by_estimator.at("mo2").contains("pan_tompkins:stride=3"));
  EXPECT_TRUE(t.sets[0].by_estimator.at("mo2").contains("clamping"));
}

}  // namespace
}  // namespace tauext::study::test
