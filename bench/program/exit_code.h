// SPDX-License-Identifier: Apache-2.0
/// @file
/// What every program says when it ends.
#pragma once

namespace tauext {

/// Exit codes of all programs.
enum ExitCode : int {
  kGood = 0,          ///< done, and the answer is good
  kAnswerIsNo = 1,    ///< done, but an entry failed
  kSlower = 1,        ///< the same of tauext-gate: a step takes more time or more instructions
  kCouldNotRun = 2,   ///< wrong flags, bad input or output, nothing ran, a broken harness
  kUpdateNeeded = 3,  ///< of tauext-gate: no baseline, or one that has to be looked at
  kInconclusive = 4,  ///< of tauext-gate: too noisy to say, or no base
  kLessAccurate = 5,  ///< of tauext-gate: an estimate is less accurate
};
/// Exit code after Ctrl-C or kill, where what was done until then is kept.
inline constexpr int kInterrupted = 130;

}  // namespace tauext
