// SPDX-License-Identifier: Apache-2.0
#include "bench/score/table.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <sstream>

namespace tauext::test {
namespace {

Row row(const char* estimator, double rmse, double settling) {
  Row r{{"wallmobot3", "step", estimator}, {}};
  r.score.set(Metric::kRmse, rmse);
  r.score.set(Metric::kSettling, settling);
  return r;
}

Row noisy(const char* estimator, double noise) {
  Row r{{"wallmobot3", "step", estimator}, {}};
  r.score.set(Metric::kNoise, noise);
  return r;
}

std::vector<std::string> lines(const std::vector<Row>& rows,
                               TableFormat format = TableFormat::kText) {
  std::istringstream in(format_table(rows, format));
  std::vector<std::string> all;
  for (std::string l; std::getline(in, l);) all.push_back(l);
  return all;
}

TEST(Table, MarksTheBestOfAColumnButNoBaseline) {
  const auto l = lines({row("truth", 0, 0), row("ekf", 1.5, 0.5), row("ndob", 2.5, 0.25)});
  ASSERT_EQ(l.size(), 5u);
  EXPECT_EQ(l[2].find('*'), std::string::npos) << l[2];
  EXPECT_NE(l[3].find("1.500*"), std::string::npos) << l[3];
  EXPECT_NE(l[4].find("0.250*"), std::string::npos) << l[4];
  EXPECT_EQ(l[4].find("2.500*"), std::string::npos) << l[4];
}

TEST(Table, MarksNobodyWhereAllAreEqual) {
  EXPECT_EQ(format_table({row("ekf", 1, 1), row("ndob", 1, 1)}).find('*'), std::string::npos);
}

TEST(Table, AnEstimateThatNoiseDoesNotTouchDoesNotCompeteInIt) {
  const auto l = lines({noisy("ekf", 0), noisy("ndob", 0.2), noisy("mo1", 0.3)});
  EXPECT_EQ(l[2].find('*'), std::string::npos) << l[2];
  EXPECT_NE(l[3].find("0.200*"), std::string::npos) << l[3];
  const auto one = lines({noisy("ekf", 0), noisy("ndob", 0.2)});
  EXPECT_EQ(one[3].find('*'), std::string::npos) << "nobody is left to be better than: " << one[3];
  const auto little = lines({noisy("ekf", 1e-9), noisy("ndob", 0.2)});
  EXPECT_NE(little[2].find("0.000*"), std::string::npos) << "little noise is some: " << little[2];
}

TEST(Table, ABandwidthIsAChoiceAndHasNoBest) {
  Row slow{{"wallmobot3", "chirp", "mo1"}, {}}, fast{{"wallmobot3", "chirp", "mo2"}, {}};
  slow.score.set(Metric::kBandwidth, 30);
  fast.score.set(Metric::kBandwidth, 42);
  EXPECT_EQ(format_table({slow, fast}).find('*'), std::string::npos);
}

TEST(Table, ShowsNeverAndFailedAndLeavesOutUnusedColumns) {
  Row failed = row("ndob", 1, 1);
  failed.score.error = "diverged at t = 2 s";
  const std::vector<Row> rows = {row("ekf", 1, std::nan("")), failed};
  const auto l = lines(rows);
  EXPECT_NE(l[0].find("settling"), std::string::npos);
  EXPECT_EQ(l[0].find("lag"), std::string::npos);
  EXPECT_NE(l[2].find("never"), std::string::npos);
  EXPECT_NE(l[3].find("FAILED: diverged at t = 2 s"), std::string::npos);
  const auto csv = lines(rows, TableFormat::kCsv);
  EXPECT_EQ(csv[0], "entry,rmse_Nm,settling_s,error");
  EXPECT_EQ(csv[1], "wallmobot3/step/ekf,1.000,never,");
  EXPECT_EQ(csv[2], "wallmobot3/step/ndob,-,-,diverged at t = 2 s");
}

TEST(Table, ColumnsAlignAndUnitsStandUnderTheirHeads) {
  const auto l =
      lines({row("ekf", 1.5, 0.5), row("inverse_dynamics:bandwidth=123.456", 22.25, 0.25)});
  EXPECT_EQ(l[0].find("rmse") + 4, l[1].find("N m") + 3);
  EXPECT_EQ(l[2].find("1.500") + 5, l[3].find("22.250") + 6);
}

TEST(Table, SaysOfEachJointWhatALogTellsWithoutATruth) {
  Row r{{"wallmobot3", "step", "mo2"}, {}};
  r.score.set_joints(Metric::kFloor, {0.1, 0.25, 0.0625});
  const auto l = lines({r});
  EXPECT_NE(l[2].find(" 0.250"), std::string::npos) << "the worst: " << l[2];
  EXPECT_EQ(l[3], "  by joint: floor 0.100 0.250 0.062 N m");
}

TEST(Legend, ExplainsEveryColumnAndNoOther) {
  const std::string text = table_legend({row("ekf", 1, 1), row("ndob", 2, 2)});
  for (const MetricRow& m : kMetrics) {
    const bool shown = m.metric == Metric::kRmse || m.metric == Metric::kSettling;
    EXPECT_EQ(text.find(m.meaning) != std::string::npos, shown) << m.key;
  }
}

TEST(Legend, ExplainsCellsWithoutAValue) {
  const std::string text = table_legend({row("ekf", 1, 1), row("ndob", 2, kNoValue)});
  EXPECT_NE(text.find("\nnever"), std::string::npos);
  EXPECT_EQ(text.find("\n- "), std::string::npos) << "every row has both";
}

TEST(ListOfMetrics, IsTheTableOfTheReadme) {
  std::ifstream in("bench/score/README.md");
  const std::string readme{std::istreambuf_iterator<char>(in), {}};
  EXPECT_NE(readme.find("\n" + list_of_metrics()), std::string::npos)
      << "bench/score/README.md: put there what tauext-bench --list-metrics prints:\n"
      << list_of_metrics();
}

TEST(ListOfMetrics, SaysInWordsWhatAMetricIs) {
  for (const MetricRow& m : kMetrics) {
    EXPECT_TRUE(m.meaning.ends_with('.')) << m.key;
    EXPECT_GE(std::count(m.meaning.begin(), m.meaning.end(), ' '), 2) << m.key;
    EXPECT_EQ(std::count(m.meaning.begin(), m.meaning.end(), '|'), 0) << m.key;
    EXPECT_LE(m.meaning.size(), 88u) << m.key << ": a line of the legend has 100 characters";
    EXPECT_FALSE(m.title.empty()) << m.key;
  }
}

}  // namespace
}  // namespace tauext::test
