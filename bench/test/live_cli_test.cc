// SPDX-License-Identifier: Apache-2.0
// tauext-live, and LCM in the other programs. Whatever sends does so in a network namespace of its
// own.
#include <gtest/gtest.h>

#include <map>
#include <regex>
#include <string>

#include "bench/test/live_programs.h"
#include "lcmtypes/log.h"
#include "lcmtypes/test/samples.h"

namespace tauext::test {
namespace {

TEST_F(LivePrograms, PlaysAScenarioByTheClockAndSumsItUp) {
  const Outcome o = run(std::string(kRun) + "--detector pan_tompkins --speed 20 --seed 3");
  EXPECT_EQ(o.code, 0) << o.text;
  EXPECT_TRUE(o.says("playing wallmobot3/collision; Ctrl-C ends")) << o.text;
  EXPECT_TRUE(o.says("wallmobot3/collision: 30000 samples in ")) << o.text;
  EXPECT_TRUE(o.says("a period is 50 us")) << o.text;
  EXPECT_TRUE(o.says("stream     none; --lcm streams")) << o.text;
  EXPECT_TRUE(std::regex_search(o.text, std::regex("\nekf +[0-9.]+ +[0-9.]+ .* 0 +1\n"))) << o.text;
}

TEST_F(LivePrograms, OpensNoSocketUnlessAsked) {
  const std::string look =
      " --duration 3 2> err & says err playing\n"
      "ls -l /proc/$!/fd | grep -c socket | sed 's/$/ sockets/'\nwait\ncat err";
  const Outcome quiet = run_script(kRun + look);
  EXPECT_TRUE(quiet.says("0 sockets\n")) << quiet.text;
  EXPECT_TRUE(quiet.says(" samples in ")) << quiet.text;
  SKIP_WITHOUT_NAMESPACE();
  const Outcome streaming = in_network(kRun + ("--lcm" + look));
  EXPECT_TRUE(streaming.says("1 sockets\n")) << streaming.text;
}

TEST_F(LivePrograms, AListenerGetsEveryMessageOfOneKilohertz) {
  SKIP_WITHOUT_NAMESPACE();
  const Outcome o = in_network(listening("--listen") + kRun +
                               "--detector pan_tompkins --lcm --rate 0 --duration 3\n" + kSumUp);
  EXPECT_EQ(o.code, 0) << o.text;
  // three estimators, an estimate and a detection each
  EXPECT_TRUE(o.says("18000 messages published, 0 failed; 0 samples dropped")) << o.text;
  EXPECT_TRUE(
      o.says("18003 sent = 18003 used + 0 late + 0 repeated + 0 rejected + 0 lost + 0 dropped"))
      << o.text;
  EXPECT_TRUE(o.says("TAUEXT_ESTIMATE_ndob")) << o.text;
}

TEST_F(LivePrograms, WithoutARouteTheLoopGoesOnAndTheRemedyIsTold) {
  SKIP_WITHOUT_NAMESPACE();
  const Outcome o = in_network(std::string(kRun) + "--lcm --duration 0.5", false);
  EXPECT_EQ(o.code, 1) << o.text;
  EXPECT_TRUE(o.says("streaming is off: no multicast route")) << o.text;
  EXPECT_TRUE(o.says("sudo ip route add 224.0.0.0/4 dev lo")) << o.text;
  EXPECT_TRUE(o.says("500 samples in ")) << o.text;
  const Outcome listen = in_network("tauext-live --listen", false);
  EXPECT_EQ(listen.code, 2);
  EXPECT_TRUE(listen.says("no multicast route")) << listen.text;
}

TEST_F(LivePrograms, ARouteThatGoesAwayIsToldOnceAndTheLoopGoesOn) {
  SKIP_WITHOUT_NAMESPACE();
  const Outcome o = in_network("(says err playing; sleep 1; ip route del 224.0.0.0/4 dev lo) &\n" +
                               std::string(kRun) + "--lcm --duration 3 2> err; wait; cat err");
  EXPECT_TRUE(o.says("3000 samples in ")) << o.text;
  EXPECT_GT(number(o, "messages published"), 100) << o.text;
  EXPECT_GT(number(o, "failed;"), 100) << o.text;
  EXPECT_TRUE(o.says("fail (no route); the run goes on")) << o.text;
  EXPECT_EQ(o.text.find("fail (no route)"), o.text.rfind("fail (no route)")) << o.text;
}

TEST_F(LivePrograms, AListenerThatIsKilledOrStoppedDoesNotMatter) {
  SKIP_WITHOUT_NAMESPACE();
  const Outcome o = in_network(
      "tauext-live --listen > /dev/null 2> first & killed=$!\n"
      "tauext-live --listen > /dev/null 2> second & stopped=$!\n"
      "says first listening; says second listening\n"
      "(says err playing; sleep 0.5; kill -KILL $killed; kill -STOP $stopped) &\n" +
      std::string(kRun) + "--lcm --rate 0 --duration 2 2> err; kill -KILL $stopped");
  EXPECT_TRUE(o.says("6000 messages published, 0 failed; 0 samples dropped")) << o.text;
}

TEST_F(LivePrograms, ForgedAndForeignMessagesAreRejectedAndCounted) {
  SKIP_WITHOUT_NAMESPACE();
  LogBuffer log;
  for (int k = 0; k < 50; ++k) {
    estimate_t e = estimate();
    e.seq = k;
    auto forged = bytes_of(e);
    forged[8 + 24 + 3] = std::byte{9};  // joints
    const auto good = bytes_of(e), foreign = tauext::write(reading(k), MessageType::kIiwa);
    log.append("TAUEXT_ESTIMATE_x", 3000 * k, good);
    log.append("TAUEXT_ESTIMATE_x", 3000 * k + 1000, forged);
    log.append("TAUEXT_ESTIMATE_x", 3000 * k + 2000, foreign);
    log.append("SOMETHING_ELSE", 3000 * k + 2500, foreign);
  }
  put_log("forged.lcm", log);
  const Outcome o =
      in_network(listening("--listen") + "lcm-logplayer forged.lcm > /dev/null\n" + kSumUp);
  EXPECT_EQ(o.code, 0) << o.text;
  EXPECT_TRUE(
      o.says("150 sent = 50 used + 0 late + 0 repeated + 100 rejected + 0 lost + 0 dropped by the "
             "kernel\nrejected: 50 of another type, 50 with an impossible count"))
      << o.text;
}

TEST_F(LivePrograms, EstimatesARobotOnTheAir) {
  SKIP_WITHOUT_NAMESPACE();
  const std::map<std::string, std::string> channels = {
      {"iiwa", "IIWA_STATUS"}, {"panda", "PANDA_STATUS"}, {"tauext", "TAUEXT_SAMPLE"}};
  for (const auto& [type, channel] : channels) {
    const Outcome o = in_network(
        "tauext-record --robot wallmobot3 --scenario contact --type " + type +
        " --out robot.lcm 2> /dev/null\n" +
        listening("--robot wallmobot3 --estimator mo1 --detector pan_tompkins --subscribe " +
                  channel + " --type " + type + " --lcm") +
        "lcm-logplayer --speed=4 robot.lcm > /dev/null\n" + kSumUp);
    EXPECT_EQ(o.code, 0) << o.text;
    // on a busy machine the first few of UDP may not arrive, and nobody can know that they were
    // sent
    EXPECT_GE(number(o, "used"), 7900) << o.text;
    EXPECT_TRUE(
        o.says("used + 0 late + 0 repeated + 0 rejected + 0 lost + 0 dropped by the kernel; "
               "0 restarts"))
        << o.text;
    const std::regex marked("\nmo1 +[0-9.]+ +[0-9.]+ .* 0 +[1-9][0-9]*\n");
    EXPECT_TRUE(std::regex_search(o.text, marked)) << o.text;
    EXPECT_GT(number(o, "messages published"), 1000) << o.text;
  }
}

TEST_F(LivePrograms, WhatANetworkDoesToMessagesIsHandledAndCounted) {
  SKIP_WITHOUT_NAMESPACE();
  LogBuffer log;
  std::int64_t time = 0;
  const auto add = [&](std::int64_t k, int n = 3) {
    log.append("ARM", time += 1000, tauext::write(reading(k, n), MessageType::kTauext));
  };
  for (int k = 0; k < 500; ++k) {
    if (k % 100 == 50) continue;      // 5 lost
    add(k % 100 == 60 ? k - 20 : k);  // 5 late copies instead of their own: 5 more lost
    if (k % 100 == 70) add(k);        // 5 repeated
    if (k % 100 == 80) add(k, 2);     // 5 of another arm
  }
  put_log("bad.lcm", log);
  const Outcome o = in_network(listening("--robot wallmobot3 --estimator mo1 --subscribe ARM") +
                               "lcm-logplayer bad.lcm > /dev/null\n" + kSumUp);
  EXPECT_EQ(o.code, 0) << o.text;
  EXPECT_TRUE(o.says("ARM: a message of 2 joints, and wallmobot3 has 3")) << o.text;
  EXPECT_TRUE(o.says(
      "input      515 sent = 490 used + 5 late + 5 repeated + 5 rejected + 10 lost + 0 dropped"))
      << o.text;
}

TEST_F(LivePrograms, ARobotFromAFileEstimatesWhatTheClosedFormDoes) {
  ASSERT_EQ(run("tauext-record --robot wallmobot3 --scenario in_motion --out log.lcm").code, 0);
  const std::string rest = " --from log.lcm --estimator mo1,dkf,aob --speed 100";
  const Outcome closed = run("tauext-live --robot wallmobot3" + rest);
  const Outcome file = run("tauext-live --robot " + kMjcf + "/wallmobot3.xml" + rest);
  ASSERT_EQ(file.code, 0) << file.text;
  for (const char* e : {"mo1", "dkf", "aob"}) {
    const std::regex rmse(std::string("\n") + e + " +([0-9.]+) +([0-9.]+) ");
    std::smatch a, b;
    ASSERT_TRUE(std::regex_search(closed.text, a, rmse)) << closed.text;
    ASSERT_TRUE(std::regex_search(file.text, b, rmse)) << file.text;
    EXPECT_EQ(a[1], b[1]) << e;  // three decimals of N m
    EXPECT_EQ(a[2], b[2]) << e;
  }
}

TEST_F(LivePrograms, TheBenchmarkIsOnTheAirAsEntriesFinish) {
  SKIP_WITHOUT_NAMESPACE();
  const Outcome o = in_network(
      listening("--listen") +
      "tauext-bench --benchmark_filter='testbed1/hold/mo.$' --lcm --benchmark_min_time=0.01 > "
      "/dev/null\n" +
      kSumUp);
  EXPECT_TRUE(o.says("testbed1/hold/mo1  rmse ")) << o.text;
  EXPECT_TRUE(o.says("testbed1/hold/mo3  rmse ")) << o.text;
  EXPECT_TRUE(o.says("3 sent = 3 used")) << o.text;
}

TEST_F(LivePrograms, InterruptedItSumsUp) {
  for (const std::string signal : {"INT", "TERM"}) {
    const Outcome o =
        run_script("rm -f out; " + std::string(kRun) +
                   "--loop > out 2>&1 & live=$!\nsays out playing; sleep 0.3; kill -" + signal +
                   " $live; wait $live; code=$?; cat out; exit $code");
    EXPECT_EQ(o.code, 0) << o.text;
    EXPECT_TRUE(o.says("loop       late by")) << o.text;
  }
}

TEST_F(LivePrograms, RealtimeIsTakenOrRefusedWithItsRemedy) {
  const std::string rest =
      "tauext-live --robot wallmobot3 --scenario free --estimator mo1 --duration 1 --lcm memq:// "
      "--realtime";
  const Outcome forbidden = run_script(
      "ulimit -r 0; ulimit -l 64; exec setpriv --reuid 65534 --clear-groups "
      "--bounding-set -all " +
      rest + " 2>&1");
  if (forbidden.code != 127) {
    EXPECT_EQ(forbidden.code, 2) << forbidden.text;
    EXPECT_TRUE(forbidden.says("--realtime: cannot ")) << forbidden.text;
    EXPECT_TRUE(forbidden.says("sudo setcap cap_sys_nice,cap_ipc_lock+ep")) << forbidden.text;
  }
  const Outcome wrong = run(rest + " 100");
  EXPECT_EQ(wrong.code, 2);
  EXPECT_TRUE(wrong.says("a priority is 1 to 99")) << wrong.text;
  const Outcome o =
      run_script(rest +
                 " 30 > out 2>&1 & live=$!\nsays out playing; sleep 0.3\n"
                 "chrt -a -p $live | grep -c 'SCHED_FIFO' | sed 's/$/ threads first/'\n"
                 "wait $live; code=$?; cat out; exit $code");
  if (o.says("--realtime: cannot")) GTEST_SKIP() << "not allowed here: " << o.text;
  EXPECT_EQ(o.code, 0) << o.text;
  EXPECT_TRUE(o.says("2 threads first")) << o.text;  // the loop, and who sends
}

TEST_F(LivePrograms, AConnectionThatIsNotThereIsAnErrorAndNoAbort) {
  for (const char* flags : {"--listen", "--robot wallmobot3 --estimator mo1 --subscribe ARM"}) {
    const Outcome o = run(std::string("tauext-live ") + flags + " --lcm tcpq://127.0.0.1:1");
    EXPECT_EQ(o.code, 2) << o.text;
    EXPECT_TRUE(o.says("tcpq://127.0.0.1:1: no connection; is a server there?")) << o.text;
  }
}

TEST_F(LivePrograms, WhatMakesNoSenseIsRefused) {
  const auto refuses = [&](const std::string& flags, const std::string& why) {
    const Outcome o = run("tauext-live " + flags);
    EXPECT_EQ(o.code, 2) << flags << "\n" << o.text;
    EXPECT_TRUE(o.says(why)) << flags << "\n" << o.text;
  };
  refuses("", "exactly one of --scenario, --from, --subscribe and --listen is required");
  refuses("--robot wallmobot3 --scenario step --from x.csv --estimator ekf", "one of");
  refuses("--robot wallmobot3 --scenario step", "tauext-live: --estimator is required");
  refuses("--scenario step --estimator ekf", "tauext-live: --robot is required");
  refuses("--robot wallmobot3 --scenario step --estimator ekf --page abc",
          "--page: Value abc not in range");
  refuses("--robot wallmobot9 --scenario step --estimator ekf", "unknown robot 'wallmobot9'");
  refuses("--robot wallmobot3 --scenario stepp --estimator ekf", "unknown scenario 'stepp'");
  refuses("--robot wallmobot3 --scenario step --estimator ekff", "unknown estimator 'ekff'");
  refuses("--robot wallmobot3 --scenario step --estimator ekf --speed 0", "--speed 0");
  refuses("--robot wallmobot3 --scenario step --estimator ekf --lcm --rate -1", "--rate -1");
  refuses("--robot wallmobot3 --scenario step --estimator ekf --lcm http://x",
          "an LCM URL begins with");
  refuses("--robot wallmobot3 --subscribe A --type ur5 --estimator ekf",
          "unknown type of message 'ur5'");
  refuses("--robot wallmobot3 --subscribe TAUEXT_ESTIMATE_ekf --estimator ekf", "would come back");
  refuses("--robot wallmobot3 --from nothing.lcm --estimator ekf", "nothing.lcm: No such file");
  refuses("--robot nothing.xml --subscribe A --estimator mo1", "nothing.xml");
  refuses("--robot " + kMjcf + "/wallmobot3.xml --scenario payload --estimator mo1",
          "unknown scenario 'payload'");
  refuses("--listen --robot wallmobot3", "--listen shows streams");
  refuses("--listen --duration -1", "--duration -1");
  refuses("--listen --lcm memq://", "memq:// does not leave a process");
  refuses("--listen --lcm 'file://x.lcm?mode=w'", "a log that is read has no mode");
  refuses("--listen --lcm 'file://x.lcm?mode=a'", "a log that is read has no mode");
  refuses("--robot wallmobot3 --from x.csv --estimator ekf --sensors dropped=0.1",
          "--sensors goes with --scenario");
  refuses("--robot wallmobot3 --subscribe A --estimator ekf --loop",
          "--loop goes with --scenario and --from");
  refuses("--robot wallmobot3 --scenario step --estimator ekf --type iiwa",
          "--type goes with --subscribe");
  refuses("--robot wallmobot3 --scenario step --estimator ekf --rate 5", "--rate goes with --lcm");
  refuses("--robot wallmobot3 --scenario step --estimator ekf --lcm 'udpm://239.1.1.1?ttl=x'",
          "'ttl=x' is no option");
  refuses("--robot " + kMjcf + "/wallmobot3.xml --from x.csv --estimator ndob",
          "unknown estimator 'ndob'; known: zero, truth");
  write("one.csv", "t,q1,qd1,tau1\n0,0,0,0\n");
  refuses("--robot wallmobot3 --from one.csv --estimator mo1",
          "wallmobot3 has 3 joints, the samples have 1");
  write("junk.lcm", "t,q1\n1,2\n");
  refuses("--robot wallmobot3 --from junk.lcm --estimator ekf", "junk.lcm: no LCM log");
}

}  // namespace
}  // namespace tauext::test
