// SPDX-License-Identifier: Apache-2.0
/// @file
/// One process of L2: every kernel of base and head in turn.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "regression/code/layouts.h"

namespace tauext::gate {

/// What a worker runs.
struct WorkerOptions {
  std::string base, head;            ///< paths of plug-ins
  std::vector<std::string> kernels;  ///< in both
  unsigned seed = 1;                 ///< of the samples
  int rounds = 20;
  double block = 60e-6;                   ///< [s] of work between two looks at the clock
  std::vector<double> injected = {0.05};  ///< [1] slowdowns of the canaries
};

/// What it found of one kernel.
struct WorkerResult {
  std::string kernel;
  double base_ns = 0, head_ns = 0;  ///< [ns] of a step, medians
  double head = 1, aa = 1;          ///< [1] medians over the rounds of head / base and copy / base
  std::vector<double> canaries;     ///< [1] of base with `injected` more steps
};

/// Samples of one life that a worker runs through.
inline constexpr int kLifeSamples = 20000;

/// Runs every kernel's rounds in a child process of this program.
/// @throws std::runtime_error with what the child said, if it failed
std::vector<WorkerResult> run_worker(const WorkerOptions& options);

/// Lays base and head out by that seed, and runs so many processes of them, each with another life.
/// @param options whose base, head and seed are of no account
/// @return by kernel  @throws std::runtime_error as run_worker and Layouts::write do
std::map<std::string, std::vector<WorkerResult>> run_layout(const Layouts& layouts, int seed,
                                                            int processes, WorkerOptions options);

/// The child: JSON on standard output. argv: worker OPTIONS-AS-JSON.
int worker_main(const std::string& options);

}  // namespace tauext::gate
