// SPDX-License-Identifier: Apache-2.0
#include "bench/study/equal_bandwidth.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>

#include "bench/roster/robots.h"
#include "mjcf/test/error_of.h"

namespace tauext::study::test {
namespace {

using tauext::test::error_of;

TEST(EqualBandwidth, RefusesWhatTheChirpCannotSee) {
  for (const double w : {0.5, 1000., -1.}) {
    EXPECT_NE(error_of([&] {
                at_equal_bandwidth(*robots().front(), w);
              }).find("1 to 200 can be measured"),
              std::string::npos);
  }
}

TEST(EqualBandwidth, SaysWhichScenariosARobotLacks) {
  EXPECT_EQ(error_of([] { at_equal_bandwidth(robot("testbed1"), 30); }),
            "this study needs the scenarios chirp, step, sine, free; testbed1 lacks chirp, step, "
            "sine, free");
}

TEST(EqualBandwidth, AnEstimatorThatNeverReachesItStaysInTheTable) {
  Worth worth;
  worth.bandwidth = 30;
  worth.noise = 0.5;
  const std::vector<AtBandwidth> rows = {{.estimator = "a", .design = 31, .worth = worth},
                                         {.estimator = "b"}};
  const Robot& r = *robots().front();
  const std::string text = format_equal_bandwidth(r, 30, rows);
  EXPECT_NE(text.find("never: no design comes within 25 %"), std::string::npos) << text;
  EXPECT_EQ(format_equal_bandwidth(r, 30, {rows[0]}).find("never"), std::string::npos);
  const auto json = nlohmann::json::parse(format_equal_bandwidth(r, 30, rows, TableFormat::kJson));
  ASSERT_EQ(json.size(), 2u);
  EXPECT_EQ(json[0]["bandwidth_rad_s"], 30);
  EXPECT_EQ(json[0]["noise_Nm"], 0.5);
  EXPECT_EQ(json[1]["estimator"], "b");
  EXPECT_TRUE(json[1]["bandwidth_rad_s"].is_null());
}

}  // namespace
}  // namespace tauext::study::test
