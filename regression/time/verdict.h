// SPDX-License-Identifier: Apache-2.0
/// @file
/// What the ratios of many layouts say about a kernel's time: pass, slower, or nobody knows.
#pragma once

#include <string>
#include <vector>

namespace tauext::gate {

/// What a layer says of one kernel or metric.
enum class Verdict { kIdentical, kPass, kNote, kFail, kInconclusive, kNoBaseline, kAccepted };
const char* name_of(Verdict v);

/// The ratios of times in one layout, each a median over its processes.
struct LayoutRatios {
  double head = 1;    ///< [1] head / base, both laid out by the same seed
  double aa = 1;      ///< [1] a copy of base / base: 1, but for noise
  double canary = 1;  ///< [1] base with 5 % more steps / base: 1.05, if the harness can see that
};

/// When a kernel is slower.
struct TimeLimits {
  double limit = 0.02;              ///< [1] an interval below that passes
  double surely = 0.01;             ///< [1] an interval above that fails
  double canary = 0.05;             ///< [1] the slowdown that is injected
  int stages[4] = {8, 16, 32, 64};  ///< layouts, in all, after each stage
  int processes = 3;                ///< of each layout
  double false_alarms = 0.01;       ///< [1] at most in so many runs, over all kernels
  double least_sd = 0.0015;         ///< [1] between layouts, where fewer of them say less
};

/// What is said of a kernel.
struct TimeVerdict {
  Verdict verdict = Verdict::kInconclusive;
  double ratio = 1, low = 1, high = 1;  ///< head / base, the mean over layouts and its 95 %
  double surely = 0;                    ///< [1] head is surely slower by that, if it is above 0
  double layout_sd = 0;                 ///< [1] between layouts
  double aa = 1, canary = 1;            ///< medians
  int layouts = 0;
  bool harness_error = false;  ///< an injected slowdown was not seen, though the A/A copy is quiet
  std::string why;
};

/// Median of the values. @throws std::logic_error without a value
double median(std::vector<double> values);

/// What Student's t with so many degrees of freedom does not exceed with that probability (above
/// .5).
double student_quantile(double probability, int degrees);

/// Judges what is there. kInconclusive with `layouts` below the last stage asks for the next stage.
///
/// The logarithms of the ratios have a mean m and a standard deviation s over the layouts. Slower:
/// Student's interval for m lies above `surely`, at a confidence that keeps the false alarms of all
/// kernels together rare, from the second stage on. Passes if the 97.5 % bound lies below `limit`,
/// or, where layouts differ too much for that, from the third stage on below 1.5 limits with m
/// below 0.75. A copy of base that is off by more than half the limit: never a verdict.
/// @param kernels that are compared in this run
/// @throws std::logic_error with fewer layouts than the first stage
TimeVerdict judge(const std::vector<LayoutRatios>& layouts, const TimeLimits& limits, int kernels);

}  // namespace tauext::gate
