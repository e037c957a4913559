// SPDX-License-Identifier: Apache-2.0
// tauext-calibrate, where recordings and robot contradict each other.
#include <gtest/gtest.h>

#include <string>

#include "bench/test/programs.h"

namespace tauext::test {
namespace {

TEST_F(Programs, CalibrateWritesNoFileWhereItIsNotSure) {
  const std::string record = "tauext-record --scenarios " + kExamples +
                             "/recordings/motions.json --every 8 --velocity_noise 1e-3 ";
  run(record + "--scenario free1 --out free.csv --robot " + kExamples + "/arm6.json");
  run(record + "--scenario loaded --out loaded.csv --robot " + kExamples +
      "/recordings/loaded.json");
  const auto refuses = [&](const std::string& flags, const std::string& why) {
    const Outcome o = run("tauext-calibrate " + flags + " --out new.json");
    EXPECT_EQ(o.code, 1) << o.text;
    EXPECT_TRUE(o.says(why)) << o.text;
    EXPECT_TRUE(o.says("new.json is not written")) << o.text;
    EXPECT_FALSE(exists("new.json"));
  };
  const std::string arm = " --robot " + kExamples + "/arm6.json";
  refuses("loaded.csv --weigh free.csv" + arm, "kg, less than nothing");
  run_system("sed 's/mass=\"\\([0-9.]*\\)\"/mass=\"1\\1\"/' " + kExamples +
             "/arm6.xml > heavy.xml");
  refuses("free.csv --robot heavy.xml", "its torque fits its masses by a factor of");
  const Outcome good = run("tauext-calibrate free.csv --out new.json" + arm);
  EXPECT_EQ(good.code, 0) << good.text;
}

}  // namespace
}  // namespace tauext::test
