// SPDX-License-Identifier: Apache-2.0
/// @file
/// The last stage of every detector: from a score to fiducial marks.
///     mark where the score rises through 1, but not within `refractory` of the last mark
/// and silence during `start_up`, in which an estimator finds a payload that it was not told of. A
/// score that is above 1 when the silence ends is marked there, unless it has lasted since before a
/// new clock. Times are judged as an estimator's (samples/clock.h); where the clock starts anew, so
/// does all of this.
#pragma once

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
  static constexpr double kMaxGap = 1;  ///< [s] between samples; a longer one starts anew

  /// @param refractory [s] after a mark without another
  /// @param start_up [s] after the first sample without any
  /// @throws std::invalid_argument if one of them is negative
  Marking(double refractory, double start_up) : refractory_(refractory), start_up_(start_up) {
    require(refractory >= 0, "refractory [s] of a detector must not be negative");
    require(start_up >= 0, "start_up [s] of a detector must not be negative");
  }

  void reset() noexcept {
    clock_.reset();
    forget();
  }

  /// Whether a sample can be used: t is the next one, or that of a new clock.
  bool accept(double t) noexcept {
    const Status status = clock_.accept(t);
    if (status == Status::kStarted && started_) {
      forget();
      score_ = 1;  // what has lasted since before is no rise
    }
    return used(status);
  }

  /// The answer to a sample that cannot.
  Detection held() const noexcept { return {false, score_, Contact::kNone}; }

  /// Whether t is the first sample, of a stream or of a new clock.
  bool starts() const noexcept { return !started_; }

  /// Whether t lies in the silence at the begin.
  bool silent(double t) const noexcept { return !started_ || t - started_at_ < start_up_; }

  /// One sample: whether it is marked, and what for.
  Detection operator()(double t, double score, Contact contact) noexcept {
    if (!started_) {
      started_ = true;
      started_at_ = t;
    }
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
  void forget() noexcept {
    started_ = marked_ = false;
    score_ = 0;
  }

  double refractory_, start_up_;
  Clock clock_{kMaxGap};
  double started_at_ = 0, marked_at_ = 0;  // [s]
  double score_ = 0;                       // the last one outside the silence
  bool started_ = false, marked_ = false;
};

}  // namespace tauext
