// SPDX-License-Identifier: Apache-2.0
// Drake's drivers of arms of seven joints, as their messages come from a log and off the air.
#include <cmath>
#include <regex>
#include <string>
#include <utility>
#include <vector>

#include "bench/logs/lcm_trace.h"
#include "bench/roster/test/hinge_arm.h"
#include "bench/test/live_programs.h"
#include "mjcf/motion.h"
#include "mjcf/plant/model.h"
#include "mjcf/record.h"

namespace tauext::test {
namespace {

// rmse [N m] of mo1, of each table
std::vector<double> rmse_of_mo1(const std::string& text) {
  const std::regex row("mo1 +([0-9.e+-]+)");
  std::vector<double> all;
  for (std::sregex_iterator r(text.begin(), text.end(), row), end; r != end; ++r) {
    all.push_back(std::stod((*r)[1]));
  }
  return all;
}

// six seconds in motion under gravity, and from one second on a load that comes and goes
Trace seven_joints(const std::string& mjcf) {
  Scenario s = quiet();
  s.duration = 6;
  s.start_on_reference = true;
  s.reference = [](double t) { return sine_motion(0.3, 1, t); };
  s.tau_ext = [](double t) { return t < 1 ? 0 : 3 * std::sin(2 * (t - 1)); };
  return record(load_mjcf(mjcf), s);
}

TEST_F(LivePrograms, EveryMessageOfADriverIsUsedWithItsSign) {
  SKIP_WITHOUT_NAMESPACE();
  write("arm.xml", hinge_arm(7));
  const Trace trace = seven_joints((folder_ / "arm.xml").string());
  ASSERT_EQ(trace.size(), 6000);
  ASSERT_GT(trace.tau.row(1).cwiseAbs().maxCoeff(), 10)
      << "N m, of which a wrong sign makes twice as many";
  for (const auto& [type, channel] : std::vector<std::pair<std::string, std::string>>{
           {"iiwa", "IIWA_STATUS"}, {"panda", "PANDA_STATUS"}}) {
    LogBuffer log;
    append_samples(readings_of(trace), message_type(type), log);
    put_log("driver.lcm", log);
    const std::string live = "--robot arm.xml --estimator mo1 ";
    const Outcome o =
        in_network("tauext-live --speed 4 --from driver.lcm " + live + "> played\n" +
                   listening("--subscribe " + channel + " --type " + type + " " + live) +
                   "lcm-logplayer --speed=4 driver.lcm > /dev/null; cat played\n" + kSumUp);
    EXPECT_EQ(o.code, 0) << o.text;
    EXPECT_TRUE(o.says("6000 samples")) << o.text;
    EXPECT_TRUE(o.says("6000 sent = 6000 used")) << o.text;
    const std::vector<double> rmse = rmse_of_mo1(o.text);
    ASSERT_EQ(rmse.size(), 2u) << o.text;  // played, and off the air
    for (const double r : rmse) {
      EXPECT_GT(r, 0);
      EXPECT_LT(r, 1) << "N m";
    }
  }
}

}  // namespace
}  // namespace tauext::test
