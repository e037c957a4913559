// SPDX-License-Identifier: Apache-2.0
// A kernel whose every operation waits for the one before it, so that it is known what makes it
// slower: as it is, elsewhere in memory, or with something added, each a plug-in of its own.
//   SUBJECT_SHIFT=n         so many bytes of code before it
//   SUBJECT_STAGES=n        60 unless said: more are more work
//   SUBJECT_DIVIDES=n       divides in the chain: hardly an instruction, but a wait
//   SUBJECT_INSTRUCTIONS=n  instructions for which nobody waits
//   SUBJECT_STALL           1 ms every 100,003 steps
//   SUBJECT_SLEEP           gives up the processor every 10,007 steps
//   SUBJECT_BAD=n           divides where the sample is bad
//   SUBJECT_BRANCH          takes a branch that nobody can predict
//   SUBJECT_FLAG=true       divides if a member says so, which its constructor sets
//   SUBJECT_FLAG_IN=type    of that member, an array unless said
//   SUBJECT_SPOILED         its arm's samples are all bad
//   SUBJECT_TABLE=1         two functions change places in a table, and the dear one is called
//   SUBJECT_EKF             instead of all that, the EKF of wallmobot3
#include <array>
#include <bit>
#include <chrono>
#include <cstdint>
#include <limits>
#include <thread>
#include <vector>

#include "bench/kit/kernels.h"
#include "estimators/ekf.h"
#include "estimators/testbed1.h"
#include "estimators/wallmobot3.h"

#define TEXT_(x) #x
#define TEXT(x) TEXT_(x)
#ifdef SUBJECT_SHIFT
asm(".text\n.skip " TEXT(SUBJECT_SHIFT) ", 0x90\n");
#endif
#ifndef SUBJECT_STAGES
#define SUBJECT_STAGES 60
#endif
#ifndef SUBJECT_DIVIDES
#define SUBJECT_DIVIDES 0
#endif
#ifndef SUBJECT_BAD
#define SUBJECT_BAD 0
#endif
#ifndef SUBJECT_FLAG_IN
#define SUBJECT_FLAG_IN std::array<bool, 1>
#endif
#ifndef SUBJECT_TABLE
#define SUBJECT_TABLE 0
#endif

namespace {

// x through so many divides, by what no compiler knows; some processors divide by 1 at once
[[maybe_unused]] double divided(double x, int times) {
  double divisor = 1.0000001;
  asm volatile("" : "+m"(divisor));
  for (int i = 0; i < times; ++i) x /= divisor;
  return x;
}

// what is called through a table, whose bytes only the linker knows
using Term = double (*)(double);
double cheap(double x) {
  return x;
}
double dear(double x) {
  return divided(x, 100);
}
constexpr Term kTable[] = {SUBJECT_TABLE == 0 ? cheap : dear, SUBJECT_TABLE == 0 ? dear : cheap};
[[maybe_unused]] int steps = 0;  // in no state, so that no reset begins anew

// tau through a chain of low-passes, and back
class Subject {
 public:
  static constexpr const char* kName = "subject";
  static constexpr int kDof = 1;

  void reset() noexcept { stages_.fill(0); }

  tauext::Estimate<1> update(const tauext::Measurement<1>& y) noexcept {
    double x = y.tau[0] - 0.1 * stages_.back();
    for (double& stage : stages_) {
      stage += 0.1 * (x - stage);
      x = stage;
    }
#ifdef SUBJECT_FLAG
    if (slow_[0]) x = divided(x, 10);
#endif
    if (SUBJECT_DIVIDES > 0) x = divided(x, SUBJECT_DIVIDES);
    stages_.back() = x;
    if (!(x - x == 0)) {  // after a bad sample it begins anew
      if (SUBJECT_BAD > 0) x = divided(x, SUBJECT_BAD);
      stages_.fill(0);
    }
    int first = 0;
    asm volatile("" : "+r"(first));
    x = kTable[first](x);
#ifdef SUBJECT_STALL
    if (++steps % 100'003 == 0) {
      const auto until = std::chrono::steady_clock::now() + std::chrono::milliseconds(1);
      while (std::chrono::steady_clock::now() < until) {
      }
    }
#endif
#ifdef SUBJECT_SLEEP
    if (++steps % 10'007 == 0) std::this_thread::sleep_for(std::chrono::microseconds(1));
#endif
#ifdef SUBJECT_BRANCH
    // the last digits of the end of the chain decide
    if (std::bit_cast<std::uint64_t>(x) >> 8 & 1) asm volatile("nop");
#endif
#ifdef SUBJECT_INSTRUCTIONS
    asm volatile(".rept " TEXT(SUBJECT_INSTRUCTIONS) "\n nop\n .endr");
#endif
    return {tauext::Vec<1>(x)};
  }

 private:
  std::array<double, SUBJECT_STAGES> stages_{};
#ifdef SUBJECT_FLAG
  SUBJECT_FLAG_IN slow_{SUBJECT_FLAG};
#endif
};

}  // namespace

TAUEXT_PLUGIN(kernels) {
#ifdef SUBJECT_EKF
  using Ekf = tauext::Ekf<tauext::WallMoBot3>;
  const tauext::WallMoBot3 arm;
  kernels.add_estimator("wallmobot3", arm, Ekf(arm, Ekf::Parameters::paper()));
#else
  tauext::Testbed1::Parameters arm;
#ifdef SUBJECT_SPOILED
  arm.theta2 = std::numeric_limits<double>::infinity();
#endif
  kernels.add_estimator("testbed1", tauext::Testbed1(arm), Subject());
#endif
}
