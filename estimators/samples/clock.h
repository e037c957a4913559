// SPDX-License-Identifier: Apache-2.0
/// @file
/// The one rule by which time stamps are judged: by the typical step, not by the last stamp.
///     0 < t - last <= min(8 typical steps, max_gap)     the sample is the next one
/// Every other stamp waits for those behind it. If the next sample goes on from `last`, it was an
/// outlier and is all that is lost. If kClockSamples in a row go on from one another, that is the
/// clock now: set back, set forward, started again, or after a gap. Of the first stamp nobody knows
/// whether it is one; if the second step is 8 times shorter than the first, it was none.
#pragma once

#include <algorithm>
#include <cmath>
#include <tuple>

#include "estimators/math/lanes.h"
#include "estimators/types.h"

namespace tauext {

/// So many samples in a row make a new clock.
inline constexpr int kClockSamples = 3;

/// Judges the time stamps of a stream of samples.
class Clock {
 public:
  /// @param max_gap [s] longest step to go on after
  explicit Clock(double max_gap) noexcept : max_gap_(max_gap) {}

  /// The next stamp makes a start.
  void reset() noexcept {
    limit_ = 0;
    started_ = false;
    waiting_ = 0;
  }

  /// Whether a sample at t [s] can be used: kOk to step by h(), kStarted to start there, kBadTime
  /// to leave it out.
  [[gnu::always_inline]] Status accept(double t) noexcept {
    const double h = t - t_;
    if (h > 0 && h <= limit_) [[likely]] {
      go_on(t, h);
      return Status::kOk;
    }
    return judge(t);
  }

  /// Whether t is the next one, for which accept(t) says kOk at once.
  bool follows(double t) const noexcept { return t - t_ > 0 && t - t_ <= limit_; }

  double h() const noexcept { return h_; }  ///< [s] from the last used sample to this one

  /// What accept() changes where time goes on as before, but t: typical h and limit of h [s].
  auto memory() noexcept { return std::tie(typical_, limit_); }
  /// Time has gone on as before, to t [s].
  void settle(double t) noexcept {
    t_ = t;
    waiting_ = 0;
  }

 private:
  static constexpr double kLong = 8;  // typical steps; more than a lost packet or two

  [[gnu::always_inline]] void go_on(double t, double h) noexcept {
    typical_ += 0.125 * (h - typical_);
    limit_ = std::min(max_gap_, kLong * typical_);
    h_ = h;
    t_ = t;
    waiting_ = 0;
  }

  [[gnu::noinline]] Status judge(double t) noexcept {
    if (!std::isfinite(t)) return Status::kBadTime;
    if (!started_) return start(t, 0);
    const double h = t - t_, from_waiting = t - waiting_t_;
    if (typical_ == 0 && h > 0 && h <= max_gap_) {
      typical_ = h;
      go_on(t, h);
      limit_ = 0;  // the next one, too, is looked at here
      return Status::kOk;
    }
    if (!sure_ && h > 0 && h <= std::min(max_gap_, kLong * typical_)) {
      if (kLong * h < typical_) return start(t, h);
      sure_ = true;
      go_on(t, h);
      return Status::kOk;
    }
    const bool in_line = waiting_ > 0 && from_waiting > 0 && from_waiting <= max_gap_;
    waiting_ = in_line ? waiting_ + 1 : 1;
    waiting_t_ = t;
    return waiting_ < kClockSamples ? Status::kBadTime : start(t, from_waiting);
  }

  Status start(double t, double typical) noexcept {
    started_ = true;
    typical_ = typical;
    sure_ = typical > 0;
    limit_ = std::min(max_gap_, kLong * typical);
    h_ = t - t_;
    t_ = t;
    waiting_ = 0;
    return Status::kStarted;
  }

  double max_gap_;
  double limit_ = 0;                    // [s] of the step to the next sample; 0: ask judge()
  double t_ = 0, h_ = 0, typical_ = 0;  // [s]; typical: 0 while there is but one sample
  double waiting_t_ = 0;                // [s] of the last sample that waits
  int waiting_ = 0;                     // samples that go on from one another, but not from t_
  bool started_ = false;
  bool sure_ = false;  // of typical_, which more than one step says
};

/// Whether a step [s] needs anew what was made for the last one. Time stamps on a grid differ in
/// their last bits, so steps alike to 1e-9 count as one.
template <class Scalar = double>
class StepChange {
 public:
  /// Whether h [s] differs from the last one, which it becomes; of one run at least.
  bool operator()(const Scalar& h) noexcept {
    using std::abs;
    const auto same = abs(h - h_) <= 1e-9 * h_;
    if (all(same)) return false;
    h_ = select(same, h_, h);
    return true;
  }
  const Scalar& h() const noexcept { return h_; }  ///< [s] the step that it was made for

  auto memory() noexcept { return std::tie(h_); }  ///< see runs/runs.h

 private:
  Scalar h_ = 0;
};

}  // namespace tauext
