// SPDX-License-Identifier: Apache-2.0
// Regions of a body in a scenario file.
#include <gtest/gtest.h>

#include <cctype>
#include <sstream>
#include <string>
#include <vector>

#include "bench/test/programs.h"

namespace tauext::test {
namespace {

class RegionPrograms : public Programs {
 protected:
  Outcome record(const std::string& region) {
    write("own.json",
          R"({"scenarios": [{"name": "meet", "duration": 2, "regions": [)" + region + "]}]}");
    return run("tauext-record --robot wallmobot3 --scenarios own.json --scenario meet --out x.csv");
  }
};

TEST_F(RegionPrograms, MeetIt) {
  const Outcome o = record(
      R"({"region": "hand", "t": 1, "direction": [0, 0, 3], "share_of_limit": 0.5,
          "at": ["link4", "link5", 0.5]})");
  ASSERT_EQ(o.code, 0) << o.text;
  std::istringstream rows(content("x.csv"));
  std::vector<double> contact;
  for (std::string line; std::getline(rows, line);) {
    if (std::isdigit(line[0]) != 0) contact.push_back(std::stod(line.substr(line.rfind(',') + 1)));
  }
  ASSERT_EQ(contact.size(), 2000U);
  EXPECT_EQ(contact[1000], 0) << "it only just touches";
  EXPECT_EQ(contact[1004], 1);
  EXPECT_EQ(contact[1100], 0);
}

TEST_F(RegionPrograms, SayWhatIsWrongWithIt) {
  const auto refuses = [&](const std::string& region, const std::string& why) {
    const Outcome o = record(region);
    EXPECT_EQ(o.code, 2) << region;
    EXPECT_TRUE(o.says("own.json: scenarios 1: regions 1: " + why)) << o.text;
    EXPECT_FALSE(exists("x.csv"));
  };
  refuses(R"({"region": "elbow", "t": 1})", "unknown body region 'elbow'; known: hand");
  refuses(R"({"region": "hand", "t": 1, "direction": [0, 0, 1], "at": ["link4", 1]})",
          "\"at\" is [\"link4\",1], and must be a site or body");
  refuses(R"({"region": "hand", "t": 1, "direction": [0, 0, 1], "force": 3})",
          "a meeting that is 'free' has no \"force\"");
  refuses(R"({"region": "face", "t": 1, "direction": [0, 0, 1], "share_of_limit": 1})",
          "share_of_limit: the face has no impact limit");
}

}  // namespace
}  // namespace tauext::test
