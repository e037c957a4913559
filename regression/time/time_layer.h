// SPDX-License-Identifier: Apache-2.0
/// @file
/// L0, L2 and L3: whether two plug-ins are the same, whether head is slower, and whether a step
/// fits into the control period.
#pragma once

#include <functional>
#include <set>
#include <string>
#include <vector>

#include "regression/time/long_run.h"
#include "regression/time/time_worker.h"
#include "regression/time/verdict.h"

namespace tauext::gate {

/// What is compared, and how hard.
struct TimeOptions {
  std::string base, head;    ///< paths of plug-ins; an empty base: L3 alone
  std::string kernels = "";  ///< regular expression; empty: all
  bool even_if_identical = false;
  std::set<std::string> counted_otherwise;  ///< kernels that execute another number of instructions
  TimeLimits limits;
  double period = 1e-3;                              ///< [s] of control; a step has a tenth of it
  std::function<void(const std::string&)> progress;  ///< may be empty
};

/// One kernel's line.
struct KernelTime {
  std::string kernel;
  double base_ns = 0, head_ns = 0;  ///< [ns] of a step, medians over processes
  TimeVerdict verdict;
  LongRun life;               ///< of a longer run
  std::string life_accepted;  ///< why its complaint is right; "" if nobody says so
  bool over_budget = false;   ///< L3
  std::vector<WorkerResult> processes;
};

/// What its layouts say; a failure also where its longer run fails.
Verdict verdict_of(const KernelTime& kernel);

/// What L0, L2 and L3 found.
struct TimeReport {
  std::vector<KernelTime> kernels;  ///< in both; kIdentical ones were not timed
  std::vector<std::string> gone;    ///< in base alone
  std::vector<KernelTime> alone;    ///< in head alone: L3, and nothing to compare with
};

/// A kernel is identical where both builds reach the same code from it, begin with the same bytes,
/// and are not known to execute other numbers of instructions.
/// @throws std::runtime_error for a plug-in that does not load or has no assembly beside it,
/// std::invalid_argument for a filter that matches nothing
TimeReport compare_times(const TimeOptions& options);

/// The names of both plug-ins' kernels that match: in both, in base alone, in head alone.
struct KernelNames {
  std::vector<std::string> both, gone, added;
};
KernelNames kernel_names(const std::string& base, const std::string& head,
                         const std::string& filter);

}  // namespace tauext::gate
