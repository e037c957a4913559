// SPDX-License-Identifier: Apache-2.0
/// @file
/// How often the time layer cries wolf on this machine, and what it finds.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "regression/time/verdict.h"

namespace tauext::gate {

/// What is tried.
struct CalibrateOptions {
  std::string base;     ///< plug-in
  std::string head;     ///< another one, that is known to be slower; empty: steps are injected
  std::string kernels;  ///< regular expression
  int trials = 20;      ///< complete runs, each with as many layouts as its verdicts need
  /// [1] injected into a commit that moves half of the functions elsewhere, and changes nothing; 0:
  /// that commit alone, for false alarms
  std::vector<double> slowdowns = {0, 0.01, 0.02, 0.03, 0.05};
  TimeLimits limits;
  std::function<void(double)> progress;  ///< called with the share that is done; may be empty
};

/// Verdicts on one slowdown, over all trials and kernels.
struct Power {
  double slowdown = 0;
  int comparisons = 0, failed = 0, inconclusive = 0;
  int trials_with_a_failure = 0;
};

/// @throws as compare_times does
std::vector<Power> calibrate(const CalibrateOptions& options);

/// A table of them, with the machine's name.
std::string format_power(const std::vector<Power>& power, const CalibrateOptions& options);

}  // namespace tauext::gate
