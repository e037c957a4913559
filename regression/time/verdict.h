// SPDX-License-Identifier: Apache-2.0
/// @file
/// What the ratios of many processes say about a kernel's time: pass, slower, or nobody knows.
#pragma once

#include <string>
#include <vector>

namespace tauext::gate {

/// What a layer says of one kernel or metric.
enum class Verdict { kIdentical, kPass, kNote, kFail, kInconclusive, kNoBaseline };
const char* name_of(Verdict v);

/// One process' ratios of times, each a median over its pairs.
struct ProcessRatios {
  double head = 1;    ///< [1] head / base
  double aa = 1;      ///< [1] a copy of base / base: 1, but for noise
  double canary = 1;  ///< [1] base with 5 % more steps / base: 1.05, if the harness can see that
};

/// When a kernel is slower.
struct TimeLimits {
  double limit = 0.02;           ///< [1] a pooled median above 1 + limit is slower
  double canary = 0.05;          ///< [1] the slowdown that is injected
  int stages[3] = {10, 20, 40};  ///< processes, in all, after each stage
};

/// What is said of a kernel.
struct TimeVerdict {
  Verdict verdict = Verdict::kInconclusive;
  double median = 1, low = 1, high = 1;  ///< of head / base; low to high: at least 89 % confidence
  double aa = 1, canary = 1;             ///< medians
  int processes = 0;
  bool harness_error = false;  ///< an injected slowdown was not seen, though the A/A copy is quiet
  std::string why;
};

/// Median of the values. @throws std::logic_error without a value
double median(std::vector<double> values);

/// Judges what is there. kInconclusive with `processes` below the last stage asks for the next
/// stage.
///
/// Slower: the median of some processes lies above 1 + limit, and the third smallest of 10 ratios
/// (6th of 20, 12th of 40) above 1, so at most 2 of 10 show no slowdown.
/// Fails if all processes say so, and those after the first stage among themselves, and the first
/// stage or else more than as many later ones. Passes if the median's
/// interval ends below 1 + limit. A copy of base that is off by more than half the limit: never a
/// verdict.
/// @throws std::logic_error with fewer processes than the first stage
TimeVerdict judge(const std::vector<ProcessRatios>& processes, const TimeLimits& limits);

}  // namespace tauext::gate
