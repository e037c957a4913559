// SPDX-License-Identifier: Apache-2.0
// The programs that write and read logs: tauext-record, -replay and -identify.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>

#include "bench/test/programs.h"

namespace tauext::test {
namespace {

TEST_F(Programs, RecordWritesTheSameBitsForTheSameSeed) {
  const std::string base =
      "tauext-record --robot wallmobot3 --scenario free --velocity_noise 1e-3 --seed ";
  EXPECT_EQ(run(base + "7 --out a.csv").code, 0);
  EXPECT_EQ(run(base + "7 --out b.csv").code, 0);
  EXPECT_EQ(run(base + "8 --out c.csv").code, 0);
  EXPECT_EQ(content("a.csv"), content("b.csv"));
  EXPECT_NE(content("a.csv"), content("c.csv"));
}

TEST_F(Programs, ReplayWritesOneRowPerSampleAndPrintsTheErrors) {
  run("tauext-record --robot wallmobot3 --scenario collision --out log.csv");
  const Outcome o =
      run("tauext-replay log.csv --robot wallmobot3 --estimator ekf,truth --detector pan_tompkins "
          "--out est.csv");
  EXPECT_EQ(o.code, 0) << o.text;
  EXPECT_TRUE(o.says("recall 1")) << o.text;
  const std::string est = content("est.csv");
  EXPECT_EQ(est.substr(0, est.find('\n')),
            "t,ekf_tau_ext1,ekf_tau_ext2,ekf_tau_ext3,ekf_status,ekf_pan_tompkins_mark,"
            "truth_tau_ext1,truth_tau_ext2,truth_tau_ext3,truth_status,truth_pan_tompkins_mark");
  EXPECT_EQ(std::count(est.begin(), est.end(), '\n'), 30001);
  const Outcome one = run(
      "tauext-replay log.csv --robot wallmobot3 --estimator ndob --detector pan_tompkins --out -");
  EXPECT_EQ(one.text.substr(0, one.text.find('\n')),
            "t,ndob_tau_ext1,ndob_tau_ext2,ndob_tau_ext3,ndob_status,pan_tompkins_mark");
}

TEST_F(Programs, ReplayWorksWithoutTruthAndReportsBadRows) {
  write("log.csv",
        "t,q1,q2,q3,qd1,qd2,qd3,tau1,tau2,tau3\n"
        "0,0,0,0,0,0,0,1,2,3\n"
        "0.001,0,0,0,0,0,inf,1,2,3\n"
        "0.002,0,0\n"
        "0.003,0,0,0,0,0,0,1,2,3\n");
  const Outcome o = run("tauext-replay log.csv --robot wallmobot3 --estimator ndob --out est.csv");
  EXPECT_EQ(o.code, 0) << o.text;
  EXPECT_TRUE(o.says("skipped 2 rows")) << o.text;
  EXPECT_TRUE(o.says("line 3: a field is not finite")) << o.text;
  const std::string est = content("est.csv");
  EXPECT_EQ(std::count(est.begin(), est.end(), '\n'), 3);
  const Outcome truth =
      run("tauext-replay log.csv --robot wallmobot3 --estimator truth --out e2.csv");
  EXPECT_EQ(truth.code, 2);
  EXPECT_TRUE(truth.says("needs columns tau_ext1..")) << truth.text;
  const Outcome twice =
      run("tauext-replay log.csv --robot wallmobot3 --estimator ndob,ndob --out e2.csv");
  EXPECT_EQ(twice.code, 2);
  EXPECT_TRUE(twice.says("'ndob' is named twice")) << twice.text;
}

TEST_F(Programs, ReplayRefusesLogsItCannotUse) {
  run("tauext-record --robot wallmobot3 --scenario free --out log.csv");
  const std::string before = content("log.csv");
  const Outcome itself =
      run("tauext-replay log.csv --robot wallmobot3 --estimator ndob --out ./log.csv");
  EXPECT_EQ(itself.code, 2);
  EXPECT_TRUE(itself.says("is the log itself")) << itself.text;
  EXPECT_EQ(content("log.csv"), before);
  write("empty.csv", "t,q1,q2,q3,qd1,qd2,qd3,tau1,tau2,tau3\nx\n");
  write("two.csv", "t,q1,q2,qd1,qd2,tau1,tau2\n0,1,2,3,4,5,6\n");
  const Outcome empty =
      run("tauext-replay empty.csv --robot wallmobot3 --estimator ndob --out est.csv");
  EXPECT_EQ(empty.code, 2);
  EXPECT_TRUE(empty.says("empty.csv: no usable row (1 skipped")) << empty.text;
  const Outcome two =
      run("tauext-replay two.csv --robot wallmobot3 --estimator ndob --out est.csv");
  EXPECT_EQ(two.code, 2);
  EXPECT_TRUE(two.says("wallmobot3 has 3 joints, the samples have 2")) << two.text;
  EXPECT_FALSE(exists("est.csv"));
}

TEST_F(Programs, IdentifyPrintsTheParametersAndWritesThem) {
  run("tauext-record --robot testbed1 --scenario identify --loadcell noise=1 --out log.csv");
  const Outcome o = run(
      "tauext-identify --terms inertia,gravity_cos,gravity_sin,coulomb log.csv --out theta.csv");
  EXPECT_EQ(o.code, 0) << o.text;
  EXPECT_TRUE(o.says("condition number")) << o.text;
  EXPECT_TRUE(o.says("gravity_cos  kg m      11.66")) << o.text;
  const std::string csv = content("theta.csv");
  EXPECT_EQ(csv.substr(0, csv.find('\n')), "term,unit,estimate,std_error");
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 5);
  const Outcome term = run("tauext-identify log.csv --terms magic --out t2.csv");
  EXPECT_EQ(term.code, 2);
  EXPECT_TRUE(term.says("unknown term 'magic'; known: inertia, gravity_cos")) << term.text;
  run("tauext-record --robot wallmobot3 --scenario free --out three.csv");
  const Outcome three = run("tauext-identify three.csv --out t2.csv");
  EXPECT_EQ(three.code, 2);
  EXPECT_TRUE(three.says("the log has 3 joints")) << three.text;
  EXPECT_FALSE(exists("t2.csv"));
}

TEST_F(Programs, RecordStopsTheMotorAtAMark) {
  const Outcome o = run(
      "tauext-record --robot testbed1 --scenario collision --stop ndob+pan_tompkins --out c.csv");
  EXPECT_EQ(o.code, 0);
  EXPECT_TRUE(o.says("stopped at 5.0")) << o.text;
  const Outcome wrong =
      run("tauext-record --robot testbed1 --scenario collision --stop ndob --out d.csv");
  EXPECT_EQ(wrong.code, 2);
  EXPECT_TRUE(wrong.says("like ekf+pan_tompkins")) << wrong.text;
  const Outcome cell =
      run("tauext-record --robot testbed1 --scenario hold --loadcell nois=1 --out d.csv");
  EXPECT_EQ(cell.code, 2);
  EXPECT_TRUE(cell.says("loadcell: there is no key 'nois'; known: scale [1] 0 to 1000"))
      << cell.text;
  EXPECT_FALSE(exists("d.csv"));
}

TEST_F(Programs, ReplayOfALogInWrongUnitsIsAnErrorAndNotAnEstimate) {
  // milliseconds in place of seconds: every sample lies beyond the longest gap
  std::string log = "\xEF\xBB\xBFt,q1,qd1,tau1\n";  // with a byte order mark
  for (int k = 0; k < 100; ++k) log += std::to_string(k) + ",0.1,0,115\n";
  write("ms.csv", log);
  const Outcome o = run("tauext-replay --robot testbed1 --estimator ekf,ndob ms.csv --out est.csv");
  EXPECT_EQ(o.code, 1) << o.text;
  EXPECT_TRUE(o.says("Samples are 1 s apart")) << o.text;
}

TEST_F(Programs, WritingToALinkWritesItsTarget) {
  fs::create_symlink(folder_ / "target.csv", folder_ / "link.csv");
  EXPECT_EQ(run("tauext-record --robot testbed1 --scenario hold --out link.csv").code, 0);
  EXPECT_TRUE(fs::is_symlink(folder_ / "link.csv"));
  EXPECT_EQ(content("target.csv").substr(0, 5), "t,q1,");
}

}  // namespace
}  // namespace tauext::test
