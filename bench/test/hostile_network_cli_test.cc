// SPDX-License-Identifier: Apache-2.0
// What strangers, broken senders and slow readers do to tauext-live.
#include <gtest/gtest.h>

#include <string>

#include "bench/test/live_programs.h"
#include "lcmtypes/test/samples.h"

namespace tauext::test {
namespace {

// the two datagrams that end whoever receives by LCM 1.3.1; `strike ADDRESS` sends them
constexpr const char* kStrike =
    "strike() {\n"
    "  printf 'LC03\\0\\0\\0\\1\\0\\0\\3\\350\\0\\0\\0\\0\\0\\0\\0\\2TAUEXT_X\\0xxxx' > first\n"
    "  (printf 'LC03\\0\\0\\0\\1\\0\\0\\3\\350\\377\\377\\374\\30\\0\\1\\0\\2'; head -c 500 "
    "/dev/zero) > far\n"
    "  exec 9<> /dev/udp/$1/7667; cat first >&9; cat far >&9; echo nonsense >&9; exec 9>&-\n"
    "}\n";

// a second machine, as a network namespace: `there COMMAND` runs in it
constexpr const char* kSecondMachine =
    "unshare -n sleep 80 & peer=$!\n"
    "while [ $(readlink /proc/$peer/ns/net) = $(readlink /proc/self/ns/net) ]; do sleep 0.1; done\n"
    "ip link add v0 type veth peer name v1 netns $peer\n"
    "there() { nsenter -t $peer -n \"$@\"; }\n"
    "ip addr add 10.9.9.1/24 dev v0; ip link set v0 up\n"
    "there ip addr add 10.9.9.2/24 dev v1; there ip link set v1 up\n"
    "there ip route add 224.0.0.0/4 dev v1\n"
    "ip route replace 224.0.0.0/4 dev v0\n"
    "sleep 0.5\n";

class HostileNetwork : public LivePrograms {
 protected:
  // so many good estimates, one each millisecond
  void put_estimates(const std::string& name, int from, int to) const {
    LogBuffer log;
    for (int k = from; k < to; ++k) {
      estimate_t e = estimate();
      e.seq = k;
      e.utime = 1000 * k;
      e.t = 1e-3 * k;
      log.append("TAUEXT_ESTIMATE_x", 1000 * k, bytes_of(e));
    }
    put_log(name, log);
  }
};

TEST_F(HostileNetwork, DatagramsThatEndLcmsReceiverAreCountedByOurs) {
  SKIP_WITHOUT_NAMESPACE();
  put_estimates("good.lcm", 0, 200);
  for (const char* mode :
       {"--listen", "--robot wallmobot3 --estimator mo1 --subscribe TAUEXT_ESTIMATE_x"}) {
    const Outcome o =
        in_network(kStrike + listening(mode) +
                   "lcm-logplayer good.lcm > /dev/null & player=$!\n"
                   "for i in 1 2 3 4 5; do strike 239.255.76.67; strike 127.0.0.1; done\n"
                   "wait $player\n" +
                   kSumUp);
    EXPECT_EQ(o.code, 0) << o.text;
    EXPECT_TRUE(
        o.says("200 sent = 200 used + 0 late + 0 repeated + 0 rejected + 0 lost + 0 dropped"))
        << o.text;
    EXPECT_TRUE(o.says("10 fragments, 5 malformed, 0 from outside")) << o.text;
  }
}

// a busy machine may keep a listener from its socket until it is asked to end
TEST_F(HostileNetwork, WhatCameBeforeCtrlCIsCounted) {
  SKIP_WITHOUT_NAMESPACE();
  put_estimates("good.lcm", 0, 200);
  for (const char* mode :
       {"--listen", "--robot wallmobot3 --estimator mo1 --subscribe TAUEXT_ESTIMATE_x"}) {
    const Outcome o = in_network(
        listening(mode) +
        "kill -STOP $live; lcm-logplayer good.lcm > /dev/null; kill -INT $live; kill -CONT $live\n"
        "wait $live; code=$?; cat heard; exit $code");
    EXPECT_EQ(o.code, 0) << o.text;
    EXPECT_TRUE(o.says("200 sent = 200 used")) << o.text;
  }
}

TEST_F(HostileNetwork, AnotherMachineIsHeardOnlyIfTheUrlSaysSo) {
  SKIP_WITHOUT_NAMESPACE();
  put_estimates("near.lcm", 0, 100);
  put_estimates("far.lcm", 0, 50);
  const std::string play =
      "there lcm-logplayer --lcm-url='udpm://239.255.76.67:7667?ttl=1' far.lcm > /dev/null\n"
      "for i in 1 2 3; do there bash -c \"$(declare -f strike); strike 10.9.9.1; strike "
      "239.255.76.67\"; done\n";
  const std::string begin = std::string(kStrike) + kSecondMachine, end = "kill $peer\n";
  const Outcome by_default = in_network(begin + listening("--listen") + play +
                                        "lcm-logplayer near.lcm > /dev/null\n" + end + kSumUp);
  EXPECT_EQ(by_default.code, 0) << by_default.text;
  EXPECT_TRUE(by_default.says("100 sent = 100 used + 0 late + 0 repeated + 0 rejected + 0 lost"))
      << by_default.text;
  EXPECT_TRUE(by_default.says("0 fragments, 0 malformed, 59 from outside")) << by_default.text;
  const Outcome asked = in_network(
      begin + listening("--listen --lcm 'udpm://239.255.76.67:7667?ttl=1'") + play + end + kSumUp);
  EXPECT_EQ(asked.code, 0) << asked.text;
  EXPECT_TRUE(asked.says("50 sent = 50 used + 0 late")) << asked.text;
  EXPECT_TRUE(asked.says("6 fragments, 3 malformed, 0 from outside")) << asked.text;
}

TEST_F(HostileNetwork, OfTwoArmsOnOneChannelTheFirstIsUsedAndBothAreNamed) {
  SKIP_WITHOUT_NAMESPACE();
  const std::string record = "tauext-record --robot wallmobot3 --type iiwa --scenario ";
  const Outcome o = in_network(
      record + "contact --out one.lcm 2> /dev/null\n" + record +
      "in_motion --out two.lcm 2> /dev/null\n" +
      listening("--robot wallmobot3 --estimator mo1 --subscribe IIWA_STATUS --type iiwa") +
      "lcm-logplayer one.lcm > /dev/null & one=$!\nsleep 0.3\n"
      "timeout 1 lcm-logplayer two.lcm > /dev/null\n"
      "grep -q 'IIWA_STATUS: .* both send on the channel; only the first is used' heard && "
      "echo within a second\n"
      "kill $one\n" +
      kSumUp);
  EXPECT_EQ(o.code, 0) << o.text;
  EXPECT_TRUE(o.says("within a second\n")) << o.text;
  EXPECT_GT(number(o, "rejected"), 500) << o.text;
}

TEST_F(HostileNetwork, EveryMessageOfABusyListenerIsAccountedFor) {
  SKIP_WITHOUT_NAMESPACE();
  const Outcome o = in_network(
      listening("--listen --lcm 'udpm://239.255.76.67:7667?recv_buf_size=100000'") + kRun +
      "--lcm --rate 0 --duration 4 > sent 2>&1 & run=$!\n"
      "says sent playing; sleep 1; kill -STOP $live; sleep 1; kill -CONT $live; wait $run\n"
      "cat sent\n" +
      kSumUp);
  EXPECT_TRUE(o.says("12000 messages published, 0 failed")) << o.text;
  EXPECT_TRUE(o.says("12003 sent = ")) << o.text;  // and a summary of each estimator
  EXPECT_TRUE(o.says("+ 0 late + 0 repeated + 0 rejected + 0 lost + ")) << o.text;
  EXPECT_GT(number(o, "dropped by the kernel"), 100) << o.text;
}

TEST_F(HostileNetwork, AReaderWhoDoesNotReadCostsNoMemory) {
  SKIP_WITHOUT_NAMESPACE();
  const Outcome o = in_network(
      "mkfifo pipe; sleep 80 < pipe & reader=$!\n"
      "tauext-live --listen > pipe 2> err & live=$!\nsays err listening\n"
      "held() { sed -n 's/VmHWM: *\\([0-9]*\\) kB/\\1/p' /proc/$live/status; }\nbefore=$(held)\n"
      "tauext-live --robot wallmobot3 --scenario collision --estimator ekf,mo2,ndob --detector "
      "pan_tompkins --lcm --rate 0 --speed 5 > /dev/null 2>&1\n"
      "kill -0 $live && echo $(($(held) - before)) kB more; kill -KILL $live $reader");
  EXPECT_GE(number(o, "kB more"), 0) << o.text;
  EXPECT_LT(number(o, "kB more"), 10'000) << o.text;
}

}  // namespace
}  // namespace tauext::test
