// SPDX-License-Identifier: Apache-2.0
// A kernel whose every operation waits for the one before it, so that it is known what makes it
// slower: as it is, elsewhere in memory, or with something added, each a plug-in of its own.
//   SUBJECT_SHIFT=n         so many bytes of code before it
//   SUBJECT_STAGES=n        60 unless said: more are more work
//   SUBJECT_DIVIDES=n       divides in the chain: hardly an instruction, but a wait
//   SUBJECT_INSTRUCTIONS=n  instructions for which nobody waits
#include <array>

#include "bench/kit/kernels.h"
#include "estimators/testbed1.h"

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

namespace {

[[maybe_unused]] volatile double divisor = 1.0000001;  // some processors divide by 1 at once

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
    for (int i = 0; i < SUBJECT_DIVIDES; ++i) x /= divisor;
    stages_.back() = x;
#ifdef SUBJECT_INSTRUCTIONS
    asm volatile(".rept " TEXT(SUBJECT_INSTRUCTIONS) "\n nop\n .endr");
#endif
    return {tauext::Vec<1>(x)};
  }

 private:
  std::array<double, SUBJECT_STAGES> stages_{};
};

}  // namespace

TAUEXT_PLUGIN(kernels) {
  kernels.add_estimator("testbed1", tauext::Testbed1(), Subject());
}
