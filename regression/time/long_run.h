// SPDX-License-Identifier: Apache-2.0
/// @file
/// A kernel's longer life: what medians of blocks cannot see, like a stall every minute.
#pragma once

#include <string>
#include <vector>

namespace tauext::gate {

/// What is run through, once on each side.
struct LongRunOptions {
  std::string base, head;            ///< paths of plug-ins
  std::vector<std::string> kernels;  ///< in both
  int samples = 200'000;             ///< the last 140,000 of them in one recording
};

/// Of so many steps each the time that the fastest of three runs from the beginning took, each in a
/// library of its own: what is left is the kernel's doing, since another process' comes elsewhere.
inline constexpr int kStepsOfABlock = 50;

/// One side of a kernel.
struct LifeTimes {
  double mean_ns = 0;   ///< [ns] of a step
  double rare_ns = 0;   ///< [ns] of a step, in the slowest of 1,000 blocks
  double worst_ns = 0;  ///< [ns] of the slowest block, all of its steps
  long waits = 0;       ///< times that it gave up the processor
};

/// Both sides, and where they differ most.
struct LongRun {
  std::string kernel;
  LifeTimes base, head;
  double worst_ratio = 1;    ///< [1] head / base of one block: the same samples
  double worst_more_ns = 0;  ///< [ns] that head took longer in that block
  int worst_at = 0;          ///< its first sample
};

/// Head may take so much longer.
struct LongRunLimits {
  double ratio = 2;        ///< [1] in a block, and
  double more_ns = 5'000;  ///< [ns] that it takes more there
  double mean = 0.5;       ///< [1] in the mean
};

/// "" or what is wrong, in words.
std::string complaint(const LongRun& run, const LongRunLimits& limits = {});

/// Runs all in a child process of this program, and those again of which there is a complaint: it
/// stays only where both runs give one.
/// @throws std::runtime_error with what the child said, if it failed
std::vector<LongRun> run_long(const LongRunOptions& options);

/// The child: JSON on standard output. argv: long-worker OPTIONS-AS-JSON.
int long_worker_main(const std::string& options);

}  // namespace tauext::gate
