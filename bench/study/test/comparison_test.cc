// SPDX-License-Identifier: Apache-2.0
#include "bench/study/detection/comparison.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "mjcf/scenarios/region_runs.h"

namespace tauext::study::test {
namespace {

// finds so many of 300 blows at each level, with so many alarms in two hours up to the third last
Cell finding(const std::string& estimator, int found, int alarms) {
  Cell c{.condition = "hard", .estimator = estimator, .detector = "high_pass"};
  c.runs = 1;
  c.blows = 300;
  c.quiet_samples = 2 * 3600 * 1000;
  c.detected_at.fill(found);
  c.alarms_at.fill(alarms);
  for (std::size_t l = kLevels.size() - 3; l < kLevels.size(); ++l) c.alarms_at[l] = 0;
  return c;
}

TEST(Cell, KnowsTheLowestFactorThatIsQuietEnough) {
  Cell c = finding("mo1", 10, 3);  // 1.5 an hour
  EXPECT_EQ(c.level_with(1.5), 0u);
  EXPECT_EQ(c.level_with(1.4), kLevels.size() - 3);
  c.alarms_at[kLevels.size() - 2] = 3;  // a level above that is louder counts, too
  EXPECT_EQ(c.level_with(1.4), kLevels.size() - 1);
  c.alarms_at.back() = 3;
  EXPECT_EQ(c.level_with(1.4), std::nullopt);
  EXPECT_EQ(Cell().level_with(1), std::nullopt) << "nothing was quiet";
}

TEST(Comparison, NamesPairsWithoutTheirKeysUnlessTheyDifferInThem) {
  const std::vector<Cell> cells = {finding("mo1:bandwidth=50", 1, 0), finding("mo2", 1, 0),
                                   finding("mo2:bandwidth=9", 1, 0)};
  EXPECT_EQ(short_name(cells[0], cells), "mo1+high_pass");
  EXPECT_EQ(short_name(cells[1], cells), "mo2+high_pass");
  EXPECT_EQ(short_name(cells[2], cells), "mo2:bandwidth=9+high_pass");
}

// Wilson's intervals of 300: 200 (61.1 to 71.8 %), 180 (54.4 to 65.4), 150 (44.4 to 55.6), 135
// (39.5 to 50.7), 20 (4.4 to 10.1)
TEST(Comparison, GroupsThoseWhoseIntervalsReachTheBestOnes) {
  const std::vector<Cell> cells = {finding("a", 150, 0), finding("b", 20, 0), finding("c", 200, 0),
                                   finding("d", 180, 0), finding("e", 135, 0)};
  const Comparison c = compare(cells).at(0);
  EXPECT_EQ(c.what, "blows");
  EXPECT_EQ(c.touches, 300);
  std::vector<std::string> names;
  for (const auto& group : c.groups) {
    for (const Standing& s : group) names.push_back(s.cell->estimator);
    names.emplace_back("|");
  }
  EXPECT_EQ(names, (std::vector<std::string>{"c", "d", "|", "a", "e", "|", "b", "|"}));
  EXPECT_NEAR(c.groups[0][0].interval.low, 0.6115, 1e-3);
  EXPECT_EQ(c.groups[0][0].factor, kLevels[0]) << "quiet at all of them";
}

TEST(Comparison, IsAtOneAlarmAnHourAndLeavesOutWhatIsNeverSoQuiet) {
  Cell loud = finding("loud", 300, 9);
  loud.alarms_at.fill(9);
  Cell often = finding("often", 290, 9);  // and quiet at the last levels alone, where it finds less
  for (std::size_t l = kLevels.size() - 3; l < kLevels.size(); ++l) often.detected_at[l] = 30;
  const std::vector<Cell> cells = {loud, often, finding("good", 100, 2)};
  const Comparison c = compare(cells).at(0);
  ASSERT_EQ(c.loud.size(), 1u);
  EXPECT_EQ(c.loud[0]->estimator, "loud");
  ASSERT_EQ(c.groups.size(), 2u);
  EXPECT_EQ(c.groups[0][0].cell->estimator, "good");
  EXPECT_EQ(c.groups[1][0].found, 30);
  EXPECT_EQ(c.groups[1][0].factor, kLevels[kLevels.size() - 3]);
  const std::string table = format_comparisons(cells);
  EXPECT_NE(table.find("good+high_pass"), std::string::npos) << table;
  const auto json = comparisons_json(cells);
  EXPECT_EQ(json.at(0).at("groups").size(), 2u);
  EXPECT_EQ(json.at(0).at("too_loud").at(0), "loud+high_pass");
  EXPECT_EQ(json.at(0).at("groups").at(1).at(0).at("found"), 30);
}

TEST(Comparison, OfRegionsIsByRegionAndByClass) {
  Cell a = finding("a", 0, 0), b = a;
  a.blows = b.blows = 0;
  b.estimator = "b";
  for (Cell* c : {&a, &b}) {
    c->regions.resize(region_classes().size());
    for (RegionCount& r : c->regions) r.touches = 100;
  }
  const RegionClass& first = region_classes().front();
  a.regions.front().found_at.fill(100);
  const std::vector<Cell> cells = {a, b};
  bool by_class = false, by_region = false;
  for (const Comparison& c : compare(cells)) {
    EXPECT_NE(c.what, "blows");
    if (c.what == first.name) {
      by_class = true;
      EXPECT_TRUE(c.of_class);
      EXPECT_EQ(c.touches, 100);
      ASSERT_EQ(c.groups.size(), 2u);
      EXPECT_EQ(c.groups[0][0].cell->estimator, "a");
    } else if (c.what == first.region->name) {
      by_region = true;
      EXPECT_EQ(c.groups[0][0].found, 100);
      EXPECT_GT(c.touches, 100);
    } else if (c.what == "clamped") {
      EXPECT_EQ(c.touches, 300) << "hand, lower arm, abdomen";
      EXPECT_EQ(c.groups.size(), 1u) << "nothing tells them apart";
    }
  }
  EXPECT_TRUE(by_class);
  EXPECT_TRUE(by_region);
}

TEST(Comparison, CellsComeByCondition) {
  std::vector<Cell> cells = {finding("a", 1, 0), finding("b", 1, 0), finding("a", 1, 0)};
  cells[2].condition = "light";
  const auto by = by_condition(cells);
  ASSERT_EQ(by.size(), 2u);
  EXPECT_EQ(by[0].size(), 2u);
  EXPECT_EQ(by[1].front().condition, "light");
}

}  // namespace
}  // namespace tauext::study::test
