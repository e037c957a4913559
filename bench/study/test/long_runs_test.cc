// SPDX-License-Identifier: Apache-2.0
// Studies that take minutes without optimisation: Release alone builds this file.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "bench/roster/robots.h"
#include "bench/score/suite.h"
#include "bench/study/detection/calibration.h"
#include "bench/study/detection/detection_study.h"
#include "bench/study/equal_bandwidth.h"
#include "bench/study/pareto.h"

namespace tauext::study::test {
namespace {

TEST(Suite, EveryEntryOfTheRosterPasses) {
  Suite suite(SuiteOptions{});
  for (const Entry& e : entries()) {
    const Score score = suite.score(e);
    EXPECT_EQ(score.error, "") << e.name();
    EXPECT_EQ(score.get(Metric::kAllocs).value_or(0), 0) << e.name();
  }
}

TEST(DetectionStudy, CalibrationDoesNotDependOnTheNumberOfThreads) {
  CalibrationOptions o;
  o.conditions = {"known_0"};
  o.runs = 2;
  o.threads = 1;
  const Thresholds one = calibrate(o);
  o.threads = 3;
  const Thresholds three = calibrate(o);
  for (const ThresholdSet& set : one.sets) {
    for (const auto& [estimator, detectors] : set.by_estimator) {
      for (const auto& [detector, trained] : detectors) {
        const Trained& other =
            three.of(set.robot, set.velocity_noise)->by_estimator.at(estimator).at(detector);
        EXPECT_EQ(trained.threshold, other.threshold) << estimator << "+" << detector;
        EXPECT_EQ(trained.metric, other.metric) << estimator << "+" << detector;
      }
    }
  }
}

// the paper's range, 0 to 150 kg, known or not, velocity noise 1e-4; a fifth of what tauext-detect
// tries
TEST(DetectionStudy, TheClassifierHoldsOverThePapersRangeBehindTheEkf) {
  StudyOptions o;
  o.conditions = {"known_0", "known_150", "unknown_150"};
  o.estimators = {"ekf"};
  o.detectors = {"contact_classifier"};
  o.blows = 120;
  o.brisk_pushes = 0;
  o.clampings = 20;
  o.hours = 0.2;
  for (const Cell& c : detection_study(o, calibrate({.estimators = {"ekf"}, .runs = 8}))) {
    EXPECT_GE(c.recall(), 0.99) << c.condition;
    EXPECT_LE(c.delays[static_cast<std::size_t>(0.95 * static_cast<double>(c.delays.size()))],
              0.015);
    EXPECT_EQ(c.alarms, 0) << c.condition;
    EXPECT_GE(c.clampings_named, 0.95 * c.clampings) << c.condition;
    EXPECT_EQ(c.failed_runs, 0);
  }
}

// that it finds less at 10 rad/s, its default, is a matter of that number, not of the method
TEST(DetectionStudy, OnGoodSensorsAHighPassAt60FindsWhatPanTompkinsFindsBehindTheEkf) {
  StudyOptions o;
  o.conditions = {"known_0", "known_150", "unknown_150", "noise_known_150"};
  o.estimators = {"ekf"};
  o.detectors = {"pan_tompkins", "high_pass:w=60"};
  o.blows = 200;
  o.brisk_pushes = o.clampings = 0;
  o.hours = 0.2;
  CalibrationOptions training;
  training.estimators = o.estimators;
  training.detectors = o.detectors;
  training.runs = 8;
  const std::vector<Cell> cells = detection_study(o, calibrate(training));
  ASSERT_EQ(cells.size(), 8u);
  for (std::size_t i = 0; i < cells.size(); i += 2) {
    EXPECT_GE(cells[i].blows, 200);
    EXPECT_NEAR(cells[i].recall(), cells[i + 1].recall(), 0.02)
        << cells[i].condition << " " << cells[i].estimator;
  }
}

const Worth& worth(const std::vector<AtBandwidth>& rows, const std::string& name) {
  const auto it = std::find_if(rows.begin(), rows.end(),
                               [&](const AtBandwidth& r) { return r.estimator == name; });
  if (it == rows.end() || !it->worth) throw std::runtime_error(name + " has no row");
  return *it->worth;
}

TEST(EqualBandwidth, SetsEveryEstimatorToTheMeasuredBandwidth) {
  const std::vector<AtBandwidth> rows = at_equal_bandwidth(robot("wallmobot3"), 30);
  EXPECT_GE(rows.size(), 10u);
  for (const AtBandwidth& r : rows) {
    ASSERT_TRUE(r.worth) << r.estimator;
    EXPECT_NEAR(r.worth->bandwidth, 30, 0.05 * 30) << r.estimator;
    // an error of 5 % of the weight is there whatever the filter
    EXPECT_NEAR(r.worth->mass_bias, worth(rows, "mo1").mass_bias, 0.01 * r.worth->mass_bias);
  }
  // first order: the design is the bandwidth, the lag its inverse, 90 % after ln 10 times that
  for (const char* name : {"mo1", "inverse_dynamics", "ndob_wb"}) {
    EXPECT_NEAR(worth(rows, name).bandwidth, 30, 0.02 * 30) << name;
    EXPECT_NEAR(worth(rows, name).lag, 1 / 30., 1.1e-3) << name;
    EXPECT_NEAR(worth(rows, name).rise_0_90, std::log(10) / 30, 0.02 * std::log(10) / 30) << name;
  }
  // Butterworth: 4.3 and 8.1 % of overshoot
  EXPECT_NEAR(worth(rows, "mo2").overshoot, 4.3, 0.3);
  EXPECT_NEAR(worth(rows, "mo3").overshoot, 8.1, 0.3);
}

TEST(Pareto, AFirstOrderObserverSettlesAfterLn50OverItsBandwidth) {
  int seen = 0;
  for (const ParetoPoint& p : pareto(robot("wallmobot3"))) {
    EXPECT_TRUE(p.has_value() || !p.on_front()) << p.estimator << " at " << p.design;
    if (p.estimator != "mo1" || p.design == 0) continue;
    ++seen;
    // samples of 1 ms: an estimate is late by up to one
    EXPECT_NEAR(p.value.settling, std::log(50) / p.design, 1.1e-3) << p.design;
    EXPECT_NEAR(p.value.rise_0_90, std::log(10) / p.design, 1.1e-3) << p.design;
    EXPECT_NEAR(p.value.overshoot, 0, 0.01) << p.design;
  }
  EXPECT_EQ(seen, 8);
}

}  // namespace
}  // namespace tauext::study::test
