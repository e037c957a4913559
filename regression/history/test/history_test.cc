// SPDX-License-Identifier: Apache-2.0
// Small steps add up and are found; noise is not.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "mjcf/test/error_of.h"
#include "regression/history/drift.h"

namespace tauext::gate {
namespace {

using tauext::test::error_of;

Record record(int number, double percent, const std::string& reference = "c0") {
  const double ratio = 1 + percent / 100;
  return {.commit = fmt::format("c{}", number),
          .date = "2026-01-01T00:00:00Z",
          .title = "a \"title\"",
          .reference = reference,
          .machine = "m",
          .kernels = {{"r/k",
                       {.ratio = ratio,
                        .low = ratio - 0.003,
                        .high = ratio + 0.003,
                        .surely = ratio - 1.004,
                        .ns = 100 * ratio,
                        .instructions = 50,
                        .instructions_ratio = 1}}},
          .metrics = {},
          .gone = {},
          .accepted = {}};
}

std::vector<Record> records(const std::vector<double>& percent) {
  std::vector<Record> history;
  for (const double p : percent) history.push_back(record(static_cast<int>(history.size()), p));
  return history;
}

// what a machine says of the same code, again and again
const std::vector<double> kFlat = {0, 0.2, -0.1, 0.1, 0, -0.2, 0.3, 0.1, -0.1, 0};

std::vector<double> after_flat(const std::vector<double>& more) {
  std::vector<double> all = kFlat;
  all.insert(all.end(), more.begin(), more.end());
  return all;
}

TEST(History, IsReadBack) {
  Record r = record(1, 1.5);
  r.metrics = {{"r/s/e rmse_Nm", 0.25}, {"r/s/e settling_s", NAN}};
  r.accepted = {{"time", "r/k", 0.03, "c0", "why"}};
  r.kernels["r/same"] = {};
  const std::string text = format_record(r) + "\n" + format_record(record(2, 1)) + "\n";
  const std::vector<Record> back = parse_history(text, "f");
  ASSERT_EQ(back.size(), 2u);
  EXPECT_EQ(format_record(back[0]), format_record(r));
  EXPECT_TRUE(std::isnan(back[0].metrics.at("r/s/e settling_s")));
  EXPECT_FALSE(back[0].kernels.at("r/same").ns);
  EXPECT_EQ(back[0].title, "a \"title\"");
}

TEST(History, ThatIsBrokenIsAnErrorThatNamesTheLine) {
  const std::string good = format_record(record(1, 0)) + "\n";
  const auto error = [&](const std::string& line) {
    return error_of([&] { parse_history(good + line, "f.jsonl"); });
  };
  EXPECT_EQ(error(good.substr(0, 50)).find("f.jsonl: line 2: no record of a commit: "), 0u);
  EXPECT_EQ(error("\n").find("f.jsonl: line 2: no record of a commit: "), 0u);
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string line = good;
    return error(line.replace(line.find(from), from.size(), to));
  };
  EXPECT_EQ(with("\"version\":1", "\"version\":7"),
            "f.jsonl: line 2: of version 7, and this program reads 1");
  EXPECT_EQ(with("\"ratio\":1.0", "\"ratio\":-1.0"),
            "f.jsonl: line 2: ratio is -1, and must be above 0");
}

TEST(Drift, IsFoundByTheFourthOfSmallSteps) {
  for (const auto& [steps, flagged] : {std::pair{1, false}, {4, true}, {6, true}}) {
    std::vector<double> ramp;
    for (int i = 1; i <= steps; ++i) ramp.push_back(1.5 * i);
    EXPECT_EQ(drift_of(records(after_flat(ramp))).any(), flagged) << steps << " steps";
    EXPECT_EQ(drift_of(records(ramp)).any(), flagged) << "with no history before";
  }
}

TEST(Drift, WhatIsAcceptedIsNone) {
  std::vector<Record> history = records(after_flat({3, 3, 3, 3}));
  EXPECT_TRUE(drift_of(history).slower());
  history[10].accepted = history[11].accepted = {{"time", "r/k", 0.033, "c9", "two more terms"}};
  EXPECT_FALSE(drift_of(history).slower());
  for (int i = 14; i < 18; ++i) history.push_back(record(i, 6.5));
  EXPECT_TRUE(drift_of(history).slower()) << "once, though it is in two records";
}

TEST(Drift, WhatWasAcceptedBeforeTheReferenceIsNoLeaveForMore) {
  std::vector<Record> history = records(after_flat({3, 3, 3, 3}));
  for (int i = 10; i < 14; ++i)
    history[static_cast<std::size_t>(i)].accepted = {{"time", "r/k", 0.033, "c9", "why"}};
  for (int i = 14; i < 18; ++i) {
    history.push_back(record(i, 3, "c13"));
    history.back().accepted = history[13].accepted;  // stale, and still in the tree
  }
  EXPECT_TRUE(drift_of(history).slower());
  std::vector<Record> first = records(after_flat({3, 3, 3, 3}));
  first[0].accepted = history[13].accepted;  // the reference is itself the first on record
  EXPECT_TRUE(drift_of(first).slower());
}

TEST(Drift, GoesOnBehindAnotherReference) {
  std::vector<Record> history = records(after_flat({4, 4, 4, 4}));  // c13 is released
  for (int i = 14; i < 20; ++i) history.push_back(record(i, 0, "c13"));
  const Drift d = drift_of(history);
  EXPECT_FALSE(d.any()) << "what was released is the reference";
  EXPECT_NEAR(d.kernels[0].level.back(), std::log(1.04), 1e-12);
  history.push_back(record(20, 0, "unknown"));
  EXPECT_EQ(drift_of(history).kernels[0].level.size(), 1u) << "nothing leads there";
}

TEST(Drift, OfMetricsIsBesideTheReference) {
  std::vector<Record> history = records({0, 0, 0, 0});
  const std::string name = "r/s/e rmse_Nm", recall = "r/s/e recall";
  history[0].metrics = {
      {name, 1.}, {recall, 0.9}, {"r/s/e settling_s", 0.1}, {"r/s/e rmse_Nm_joint2", 1.}};
  history[1].metrics = {{name, 1.012}};
  EXPECT_FALSE(drift_of(history).any());
  history[2].metrics = {{name, 1.021}};
  ASSERT_EQ(drift_of(history).metrics.size(), 1u) << "each step below the gate's limit";
  EXPECT_EQ(drift_of(history).metrics[0].before, 1.);
  history[3].metrics = {{recall, 0.8}, {"r/s/e settling_s", NAN}, {"r/s/e rmse_Nm_joint2", 1.03}};
  const Drift d = drift_of(history);
  ASSERT_EQ(d.metrics.size(), 4u);
  EXPECT_EQ(d.metrics[0].name, "r/s/e settling_s") << "it never settles";
  EXPECT_EQ(d.metrics[1].name, recall) << "larger is better";
  EXPECT_EQ(d.metrics_moved, 4);
  history.push_back(record(4, 0));
  history.back().gone = {recall};
  EXPECT_EQ(drift_of(history).metrics.size(), 3u) << "what nobody measures any more";
}

// github.com/benchmark-action/github-action-benchmark, README: an array of name, unit, value, range
TEST(History, GoesToCharts) {
  const nlohmann::json charts = nlohmann::json::parse(format_for_charts(record(1, 1.5)));
  ASSERT_EQ(charts.size(), 1u);
  EXPECT_EQ(charts[0].at("name"), "r/k");
  EXPECT_EQ(charts[0].at("unit"), "% of the time of c0");
  EXPECT_DOUBLE_EQ(charts[0].at("value"), 101.5);
  EXPECT_EQ(charts[0].at("range"), "101.20 to 101.80");
}

TEST(Sparkline, HasABarForEachValue) {
  EXPECT_EQ(sparkline({}, 40), "");
  EXPECT_EQ(sparkline({0, 0.08}, 40), "▁█");
  EXPECT_EQ(sparkline({0, 0.001}, 40), "▁▁") << "a change of nothing looks like nothing";
  EXPECT_EQ(sparkline({5, 0, 0.04, 0.08}, 3), "▁▅█") << "the last ones";
}

}  // namespace
}  // namespace tauext::gate
