// SPDX-License-Identifier: Apache-2.0
#include "regression/accuracy/accuracy.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gtest/gtest.h>

#include <cmath>

namespace tauext::gate {
namespace {

Golden golden(const std::string& metric, const std::vector<double>& values,
              const std::string& contacts = "") {
  Golden g;
  g.header = {{"mujoco", "2.2.2"}, {"sensors", "velocity_noise=0.001"}, {"contacts", contacts}};
  for (std::size_t i = 0; i < values.size(); ++i) g.seeds.push_back(fmt::format("seed {}", i + 1));
  g.lines[{"r/s/e", "max_at_s"}] = {std::vector<double>(values.size(), 5.004)};
  g.lines[{"r/s/e", metric}] = {values};
  return g;
}

// what became of the metric; kUnchanged if there is nothing to say
MetricChange change(const std::string& metric, const std::vector<double>& before,
                    const std::vector<double>& after, const std::string& contacts = "") {
  const AccuracyReport r =
      compare_accuracy(golden(metric, before), golden(metric, after, contacts));
  EXPECT_LE(r.changes.size(), 1u);
  return r.changes.empty() ? MetricChange{.change = Change::kUnchanged} : r.changes[0];
}

const std::vector<double> kFive = {1.00, 1.02, 0.98, 1.01, 0.99};

std::vector<double> multiplied(double factor) {
  std::vector<double> v = kFive;
  for (double& x : v) x *= factor;
  return v;
}

TEST(Accuracy, TheSameIsUnchangedAndSoIsRoundOff) {
  EXPECT_EQ(change("rmse_Nm", kFive, kFive).change, Change::kUnchanged);
  EXPECT_EQ(change("rmse_Nm", kFive, multiplied(1 + 5e-10)).change, Change::kUnchanged);
  EXPECT_EQ(change("rmse_Nm", {1000, 1000}, {1000 + 5e-7, 1000}).change, Change::kUnchanged)
      << "relative above 1";
}

TEST(Accuracy, T1SeesAChangeAboveTheTolerance) {
  EXPECT_EQ(change("rmse_Nm", kFive, multiplied(1 + 5e-9)).change, Change::kChanged);
  EXPECT_EQ(change("rmse_Nm", kFive, multiplied(1 - 5e-9)).change, Change::kChanged)
      << "better or worse";
  EXPECT_EQ(change("rmse_Nm", kFive, multiplied(1 + 5e-9), "q/s r/s").change, Change::kUnchanged)
      << "a contact";
  EXPECT_EQ(change("rmse_Nm", kFive, multiplied(1 + 5e-9), "r/other").change, Change::kChanged);
  std::vector<double> one = kFive;
  one[3] += 1e-6;
  EXPECT_EQ(change("rmse_Nm", kFive, one).change, Change::kChanged) << "one seed is enough";
}

TEST(Accuracy, T2FailsAMeanThatIsWorseByHalfAPercent) {
  EXPECT_EQ(change("rmse_Nm", kFive, multiplied(1.006)).change, Change::kWorse);
  EXPECT_EQ(change("rmse_Nm", kFive, multiplied(1.004)).change, Change::kChanged);
  EXPECT_EQ(change("rmse_Nm", kFive, multiplied(0.9)).change, Change::kBetter);
  EXPECT_EQ(change("recall", kFive, multiplied(0.9)).change, Change::kWorse) << "larger is better";
  EXPECT_EQ(change("bandwidth_rad_s", kFive, multiplied(1.1)).change, Change::kBetter);
  EXPECT_EQ(change("max_at_s", kFive, multiplied(1.1)).change, Change::kChanged) << "neither";
}

TEST(Accuracy, AMetricThatIsNotInTheListIsBetterTheLessItIs) {
  EXPECT_EQ(change("outside_Nm", kFive, multiplied(1.1)).change, Change::kWorse);
  EXPECT_EQ(change("outside_Nm", kFive, multiplied(0.9)).change, Change::kBetter);
}

TEST(Accuracy, T2WantsThreeStandardErrors) {
  // differences 0.1 +- 0.1: mean 0.1, standard error 0.1 / sqrt 5 = 0.0447 -> 2.2
  const MetricChange c = change("rmse_Nm", {1, 1, 1, 1, 1}, {1.2, 1.0, 1.2, 1.0, 1.1});
  EXPECT_EQ(c.change, Change::kChanged);
  EXPECT_NEAR(c.standard_errors, 0.1 / (0.1 / std::sqrt(5.)), 1e-9);
  EXPECT_EQ(change("rmse_Nm", {1, 1, 1, 1, 1}, {1.12, 1.1, 1.12, 1.1, 1.11}).change,
            Change::kWorse);
}

TEST(Accuracy, PairingSeesWhatTheSpreadOfSeedsHides) {
  // seeds differ by a factor of 3, the change is 1 %
  EXPECT_EQ(change("rmse_Nm", {1, 2, 3}, {1.01, 2.02, 3.03}).change, Change::kWorse);
}

TEST(Accuracy, AMetricThatLosesItsValueIsWorse) {
  EXPECT_EQ(change("settling_s", {1, 1, 1}, {1, kNever, kNever}).change, Change::kWorse);
  EXPECT_EQ(change("settling_s", {kNever, kNever, 1}, {1, 1, 1}).change, Change::kBetter);
  EXPECT_EQ(change("settling_s", {1, 1, 1}, {1, 1, kNever}).change, Change::kChanged)
      << "one seed's step over the edge is for a reviewer";
  EXPECT_EQ(change("bandwidth_rad_s", {50, 50}, {kNever, kNever}).change, Change::kChanged)
      << "never falls: the best there is";
  EXPECT_EQ(change("delay_s", {0.1, kNever, 0.1}, {0.2, kNever, 0.2}).change, Change::kWorse)
      << "by the seeds that have a value";
  EXPECT_EQ(change("settling_s", {kNever, kNever}, {kNever, kNever}).change, Change::kUnchanged);
}

TEST(Accuracy, FromNothingToSomethingIsWorse) {
  EXPECT_EQ(change("allocs", {0, 0, 0}, {1, 1, 1}).change, Change::kWorse);
  EXPECT_EQ(change("failed", {0, 0, 0}, {1, 1, 1}).change, Change::kWorse);
  EXPECT_EQ(change("failed", {0, 0, 0, 0, 0}, {0, 0, 1, 0, 0}).change, Change::kWorse)
      << "one is enough";
}

TEST(Accuracy, NamesTheWorstSeedAndWhereItsErrorIs) {
  const MetricChange c = change("rmse_Nm", {1, 1, 1}, {1.1, 1.3, 1.2});
  EXPECT_EQ(c.worst_seed, "seed 2");
  EXPECT_EQ(c.largest_error_at, "5.004");
}

TEST(Accuracy, SeesSwappedSeeds) {
  const MetricChange c = change("rmse_Nm", {1, 2, 3}, {2, 1, 3});
  EXPECT_EQ(c.change, Change::kChanged);
  EXPECT_EQ(c.note, "the same values, the seeds swapped");
}

TEST(Accuracy, SeesWhatIsNewAndWhatIsGone) {
  Golden baseline = golden("rmse_Nm", {1, 2}), head = golden("rmse_Nm", {1, 2});
  baseline.lines[{"r/s/old", "rmse_Nm"}] = {{1, 2}};
  head.lines[{"r/s/new", "rmse_Nm"}] = {{1, 2}};
  const AccuracyReport r = compare_accuracy(baseline, head);
  ASSERT_EQ(r.changes.size(), 2u);
  EXPECT_NE(r.changes[0].change, r.changes[1].change);
  // with a filter that leaves it out nothing is gone
  EXPECT_EQ(compare_accuracy(baseline, head, "/new$|/e$").changes.size(), 1u);
}

TEST(Accuracy, IsNotComparedWithAnotherMuJoCoOtherSensorsOrSeeds) {
  const Golden g = golden("rmse_Nm", {1, 2});
  Golden other = g;
  other.header["mujoco"] = "2.3.0";
  EXPECT_NE(compare_accuracy(g, other).no_baseline.find("mujoco '2.2.2', this is '2.3.0'"),
            std::string::npos);
  other = g;
  other.header["sensors"] = "";
  EXPECT_NE(compare_accuracy(g, other).no_baseline, "");
  EXPECT_NE(compare_accuracy(g, golden("rmse_Nm", {1, 2, 3})).no_baseline, "");
}

TEST(Accuracy, T0WantsTheSameBits) {
  const Golden once = golden("rmse_Nm", {1, 2});
  EXPECT_TRUE(not_repeated(once, golden("rmse_Nm", {1})).empty());
  EXPECT_EQ(not_repeated(once, golden("rmse_Nm", {1 + 1e-15})).size(), 1u);
  EXPECT_TRUE(not_repeated(golden("lag_s", {kNever}), golden("lag_s", {kNever})).empty());
}

}  // namespace
}  // namespace tauext::gate
