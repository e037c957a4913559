// SPDX-License-Identifier: Apache-2.0
/// @file
/// One process of L2: every kernel of base and head in turn, inside Google Benchmark.
#pragma once

#include <string>
#include <vector>

#include "regression/time/verdict.h"

namespace tauext::gate {

/// What a worker runs.
struct WorkerOptions {
  std::string base, head;            ///< paths of plug-ins
  std::vector<std::string> kernels;  ///< in both
  int pairs = 75;
  double block = 60e-6;                   ///< [s] of work between two looks at the clock
  std::vector<double> injected = {0.05};  ///< [1] slowdowns of the canaries
};

/// What it found of one kernel.
struct WorkerResult {
  std::string kernel;
  double base_ns = 0, head_ns = 0;  ///< [ns] of a step, medians
  double head = 1, aa = 1;          ///< [1] medians over the pairs of head / base and copy / base
  std::vector<double> canaries;     ///< [1] likewise of base with `injected` more steps
};

/// Runs every kernel's pairs in a child process of this program, with its output on the other end
/// of a pipe.
/// @throws std::runtime_error with what the child said, if it failed
std::vector<WorkerResult> run_worker(const WorkerOptions& options);

/// The child: JSON of Google Benchmark on standard output. argv: worker OPTIONS-AS-JSON.
int worker_main(const std::string& options);

}  // namespace tauext::gate
