// SPDX-License-Identifier: Apache-2.0
/// @file
/// The last stage of every detector: from a score to fiducial marks.
///     mark where the score rises through 1, but not within `refractory` of the last mark
/// and silence during `start_up`, in which an estimator finds a payload that it was not told of. A
/// score that is above 1 when the silence ends is marked there.
#pragma once

#include <cmath>
#include <tuple>

#include "estimators/sampling.h"

namespace tauext {

/// The parameters of the marks of a detector, as its Parameters list them.
template <class P>
constexpr auto marking_fields() {
  return std::tuple(
      Field{"refractory", &P::refractory, "s", 0, 1e4, "how long no second mark follows a mark"},
      Field{"start_up", &P::start_up, "s", 0, 1e4, "how long there is no mark at first"});
}

/// A threshold for each joint, as Parameters list it.
template <class P>
constexpr auto threshold_field(const char* unit) {
  return Field{"threshold", &P::threshold, unit, 1e-12, 1e15, "larger misses more, alarms less"};
}

/// Marks of one detector.
class Marking {
 public:
  /// @param refractory [s] after a mark without another
  /// @param start_up [s] after the first sample without any
  /// @throws std::invalid_argument if one of them is negative
  Marking(double refractory, double start_up) : refractory_(refractory), start_up_(start_up) {
    require(refractory >= 0, "refractory [s] of a detector must not be negative");
    require(start_up >= 0, "start_up [s] of a detector must not be negative");
  }

  void reset() noexcept {
    started_ = marked_ = false;
    score_ = 0;
  }

  /// Whether a sample can be used: t is a number and later than the last one.
  bool accepts(double t) const noexcept { return std::isfinite(t) && (!started_ || t > t_); }

  /// The answer to a sample that cannot.
  Detection held() const noexcept { return {false, score_, Contact::kNone}; }

  /// Whether t lies in the silence at the begin.
  bool silent(double t) const noexcept { return !started_ || t - started_at_ < start_up_; }

  /// One sample: whether it is marked, and what for.
  Detection operator()(double t, double score, Contact contact) noexcept {
    if (!started_) {
      started_ = true;
      started_at_ = t;
    }
    t_ = t;
    if (silent(t)) return {false, score, Contact::kNone};
    const bool rises = score >= 1 && score_ < 1;
    const bool mark = rises && (!marked_ || t - marked_at_ >= refractory_);
    if (mark) {
      marked_ = true;
      marked_at_ = t;
    }
    score_ = score;
    return {mark, score, mark ? contact : Contact::kNone};
  }

 private:
  double refractory_, start_up_;
  double t_ = 0, started_at_ = 0, marked_at_ = 0;  // [s]
  double score_ = 0;                               // the last one outside the silence
  bool started_ = false, marked_ = false;
};

}  // namespace tauext
