// SPDX-License-Identifier: Apache-2.0
#include "bench/table.h"

#include <gtest/gtest.h>

#include <cmath>
#include <sstream>

namespace tauext::test {
namespace {

Row row(const char* estimator, double rmse, double settling) {
  return {{"arm", "step", estimator, ""}, {{{"rmse_Nm", rmse}, {"settling_s", settling}}, ""}};
}

std::vector<std::string> lines(const std::vector<Row>& rows) {
  std::istringstream in(format_table(rows));
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

TEST(Table, ShowsNeverAndFailedAndLeavesOutUnusedColumns) {
  Row failed = row("ndob", 1, 1);
  failed.score.error = "diverged at t = 2 s";
  const auto l = lines({row("ekf", 1, std::nan("")), failed});
  EXPECT_NE(l[0].find("settling"), std::string::npos);
  EXPECT_EQ(l[0].find("lag"), std::string::npos);
  EXPECT_NE(l[2].find("never"), std::string::npos);
  EXPECT_NE(l[3].find("FAILED: diverged at t = 2 s"), std::string::npos);
}

TEST(Table, ColumnsAlignAndUnitsStandUnderTheirHeads) {
  const auto l =
      lines({row("ekf", 1.5, 0.5), row("an_estimator_with_a_rather_long_name", 22.25, 0.25)});
  EXPECT_EQ(l[0].find("rmse") + 4, l[1].find("N m") + 3);
  EXPECT_EQ(l[2].find("1.500") + 5, l[3].find("22.250") + 6);
}

}  // namespace
}  // namespace tauext::test
