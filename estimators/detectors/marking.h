// SPDX-License-Identifier: Apache-2.0
/// @file
/// The last stage of every detector: from a score to fiducial marks.
///     mark where the score rises through 1, but not within `refractory` of the last mark
/// and silence during `start_up`, in which an estimator finds a payload that it was not told of. A
/// score that is above 1 when the silence ends is marked there, unless it has lasted since before a
/// new clock. Times are judged as an estimator's (samples/clock.h); where the clock starts anew, so
/// does all of this.
#pragma once

#include <algorithm>
#include <limits>
#include <tuple>
#include <type_traits>

#include "estimators/math/lanes.h"
#include "estimators/sampling.h"

namespace tauext {

/// The result of comparing two such numbers: bool for doubles, a mask for Packs.
template <class Scalar>
using MaskOf = decltype(Scalar() < Scalar());
/// The mask that is false for every run.
template <class Scalar>
MaskOf<Scalar> no() noexcept {
  return Scalar(0) < Scalar(0);
}

/// As Detection, of several runs of one clock: Scalar is a Pack.
template <class Scalar>
struct RunsDetection {
  MaskOf<Scalar> mark;  ///< of each run
  Scalar score;         ///< [1] of each run
  Scalar contact;       ///< the number of the Contact of each run
};

/// What a detector answers that computes with Scalar.
template <class Scalar>
using DetectionOf =
    std::conditional_t<std::is_same_v<Scalar, double>, Detection, RunsDetection<Scalar>>;

/// [1] the score of a detector that compares each joint's statistic with a threshold of its own.
template <class Scalar>
[[gnu::always_inline]] inline Scalar largest_ratio(const JointVec<Scalar>& statistic,
                                                   const JointVec<>& threshold) noexcept {
  using std::max;
  Scalar most = statistic[0] / Scalar(threshold[0]);
  for (Eigen::Index i = 1; i < statistic.size(); ++i)
    most = max(most, statistic[i] / Scalar(threshold[i]));
  return most;
}

/// A contact as DetectionOf<Scalar> says it, of all runs.
template <class Scalar>
auto contact_as(Contact c) noexcept {
  if constexpr (std::is_same_v<Scalar, double>) {
    return c;
  } else {
    return Scalar(static_cast<double>(c));
  }
}

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

/// Whether a detector may compute with what was measured; of several runs somebody has looked.
template <class Scalar>
bool measured(const JointVecView<Scalar>& x) noexcept {
  if constexpr (std::is_same_v<Scalar, double>)
    return within(x, kMeasurementLimit);
  else
    return true;
}

/// [s] the time of what has never been.
inline constexpr double kNever = -std::numeric_limits<double>::infinity();

/// Marks of one detector; with a Pack for Scalar, of several runs of one clock.
template <class Scalar = double>
class BasicMarking {
 public:
  static constexpr double kMaxGap = 1;  ///< [s] between samples; a longer one starts anew

  /// @param refractory [s] after a mark without another
  /// @param start_up [s] after the first sample without any
  /// @throws std::invalid_argument if one of them is negative
  BasicMarking(double refractory, double start_up) : refractory_(refractory), start_up_(start_up) {
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
  DetectionOf<Scalar> held() const noexcept {
    return {no<Scalar>(), score_, contact_as<Scalar>(Contact::kNone)};
  }

  /// Whether t is the first sample, of a stream or of a new clock.
  bool starts() const noexcept { return !started_; }

  /// Whether t lies in the silence at the begin.
  bool silent(double t) const noexcept { return !started_ || t - started_at_ < start_up_; }

  /// One sample: whether it is marked, and what for.
  [[gnu::always_inline]] DetectionOf<Scalar> operator()(double t, const Scalar& score,
                                                        Contact contact) noexcept {
    const auto none = contact_as<Scalar>(Contact::kNone);
    if (!started_) {
      started_ = true;
      started_at_ = t;
    }
    if (silent(t)) return {no<Scalar>(), score, none};
    MaskOf<Scalar> mark = (score >= 1) & (score_ < 1);
    score_ = score;
    if (!any(mark)) [[likely]]
      return {mark, score, none};
    mark = mark & (t - marked_at_ >= refractory_);
    marked_at_ = select(mark, Scalar(t), marked_at_);
    return {mark, score, select(mark, contact_as<Scalar>(contact), none)};
  }

 private:
  void forget() noexcept {
    started_ = false;
    marked_at_ = kNever;
    score_ = 0;
  }

  double refractory_, start_up_;
  Clock clock_{kMaxGap};
  double started_at_ = 0;      // [s]
  Scalar marked_at_ = kNever;  // [s]
  Scalar score_ = 0;           // the last one outside the silence
  bool started_ = false;
};

/// Of one run.
using Marking = BasicMarking<>;

}  // namespace tauext
