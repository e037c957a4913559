// SPDX-License-Identifier: Apache-2.0
/// @file
/// What an estimator does with a sample before any arithmetic: every estimator asks here first.
/// A sample is used if its time is the next one (samples/clock.h) and every joint's reading is one
/// that the arm can have (samples/limits.h): inside its limits, and, from the last used sample on,
///     |q_k - q_k-1 - h (qd_k + qd_k-1) / 2| <= 0.005 + 8 h |qd_k-1|                         (i)
///     |qd_k - qd_k-1| <= 0.02 + h qdd_max + 6 times what is usual of this sensor            (ii)
/// Others are left out, and the estimate is held. A jump by (ii) that the next sample bears out, at
/// the same joint by up to twice as much, was a blow, which costs that one sample; one by (i) is a
/// new position when kClockSamples in a row agree on it, unless it is by whole turns: that is the
/// same position of a hinge, and costs nothing. A start that the next sample does not bear out is
/// made anew. A torque that is held is not needed before the next sample, which tells: if tau has
/// jumped by more than dtau_max and back, the one before the jump takes its place, and the next kOk
/// names the joints. A joint that says it moves and whose q stays the same is frozen, and one that
/// moves and whose qd does (samples/stillness.h); its samples are left out until it speaks again.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <tuple>

#include "estimators/math/each.h"
#include "estimators/math/lanes.h"
#include "estimators/samples/clock.h"
#include "estimators/samples/limits.h"
#include "estimators/samples/options.h"
#include "estimators/samples/plain.h"
#include "estimators/samples/stillness.h"
#include "estimators/types.h"

namespace tauext {

/// A norm [N m] beyond which an estimate has diverged.
inline constexpr double kEstimateLimit = 1e9;

/// |x| <= limit; false if an element is NaN or infinite.
template <class Derived>
bool within(const Eigen::MatrixBase<Derived>& x, double limit) noexcept {
  return all(x.squaredNorm() <= typename Derived::Scalar(limit * limit));
}

/// Whether all numbers are finite.
template <class Derived>
bool finite(const Eigen::MatrixBase<Derived>& x) noexcept {
  using Scalar = typename Derived::Scalar;
  return all((x - x).sum() == Scalar(0));
}

/// Parameters are checked when an estimator is built, which may throw; its steps never do.
/// @throws std::invalid_argument(what) unless ok
inline void require(bool ok, const char* what) {
  if (!ok) throw std::invalid_argument(what);
}

/// The samples that an estimator of N joints has used, and its verdict on the next one. Of a Pack:
/// runs/sampling_of_runs.h.
template <int N, class Scalar = double>
class Sampling {
 public:
  /// @param max_gap [s] longest step to integrate over
  /// @param limits of the arm: limits_of(model)
  /// @param torque when tau acts
  /// @throws std::invalid_argument if max_gap is not positive
  explicit Sampling(double max_gap, const ArmLimits<N>& limits = {},
                    TorqueSampling torque = TorqueSampling::kHeld)
      : clock_(max_gap), rules_(padded(limits)), torque_(torque) {
    require(max_gap > 0, "max_gap [s] must be positive");
    reset();
  }

  /// The next sample makes a start.
  void reset() noexcept {
    clock_.reset();
    waiting_ = 0;
    jumped_ = joints_ = 0;
    watch_ = false;
    stillness_.reset();
    speed_.reset();
    doubted_ = wrapped_ = false;
    last_.q.setConstant(std::nan(""));  // which no reading repeats
    rules_.usual.setZero();
  }

  /// Whether y can be used: kOk to step by h(), kStarted to start at y, else what is wrong with it,
  /// and it has to be left out.
  [[gnu::always_inline]] Status accept(const Measurement<N>& sample) noexcept {
    const Sample y = padded(sample);
    if (clock_.follows(y.t) && !watch_ && rules_.plain(last_, y, y.t - last_.t)) [[likely]] {
      clock_.accept(y.t);
      learn(y);
      remember(y);
      return Status::kOk;
    }
    return judge(y);
  }

  /// For a filter that finds these joints of the sample just accepted unlikely: kUnlikely, not to
  /// be corrected by it. kOk if there are none, and where the next sample bears it out.
  [[gnu::always_inline]] Status confirm(std::uint8_t unlikely) noexcept {
    doubted_ = unlikely != 0 && !doubted_;
    if (!doubted_) [[likely]]
      return Status::kOk;
    joints_ = unlikely;
    return Status::kUnlikely;
  }

  /// [N m] that acted over the step to this sample, which was accepted.
  [[gnu::always_inline]] Vec<N> torque(const Measurement<N>& y) const noexcept {
    return torque_ == TorqueSampling::kHeld ? torque_before()
                                            : Vec<N>(0.5 * (torque_before() + y.tau));
  }

  /// [N m] tau of the used sample before this one.
  Vec<N> torque_before() const noexcept { return held_.template head<N>(); }
  double h() const noexcept { return clock_.h(); }  ///< [s] from the last used sample to this one

  /// Whether q has wrapped at the sample that was just accepted.
  bool wrapped() const noexcept { return wrapped_; }
  /// [rad] by which it then has; a filter of q has to do the same.
  Vec<N> turns() const noexcept { return turns_.template head<N>(); }

  /// All that plain samples change: what is remembered of the last one; see runs/runs.h.
  auto memory() noexcept {
    return std::tuple_cat(clock_.memory(), std::tie(last_.t, last_.q, last_.qd, last_.tau, held_,
                                                    rules_.usual, speed_.changes()));
  }
  /// Since plain samples followed the last one that accept() has judged, no other one waits.
  void settle() noexcept {
    clock_.settle(last_.t);
    waiting_ = 0;
    joints_ = 0;
    wrapped_ = doubted_ = false;
  }
  /// Whether the next sample, plain or not, has to be judged.
  bool watches() const noexcept { return watch_; }

  /// Which joints the last verdict is about, bit 0 for the first; 0 where it is about none.
  std::uint8_t joints() const noexcept { return joints_; }

 private:
  static constexpr int P = detail::kPadded<N>;  // lanes; those beyond N repeat the first joint
  using Sample = Measurement<P>;
  static_assert(N <= 8, "a bit for each joint");
  static constexpr std::uint16_t kFresh = 0x100;  // the last sample was a start

  [[gnu::always_inline]] static Vec<P> padded(const Vec<N>& v) noexcept {
    Vec<P> out;
#pragma GCC unroll 8
    for (int j = 0; j < P; ++j) out[j] = v[j < N ? j : 0];
    return out;
  }
  [[gnu::always_inline]] static Sample padded(const Measurement<N>& y) noexcept {
    return {y.t, padded(y.q), padded(y.qd), padded(y.tau)};
  }
  static ArmLimits<P> padded(const ArmLimits<N>& a) noexcept {
    return {padded(a.q_least), padded(a.q_most), padded(a.qd), padded(a.tau),
            padded(a.qdd),     padded(a.dtau),   a.turns};
  }

  [[gnu::always_inline]] void remember(const Sample& y) noexcept {
    held_ = last_.tau;
    last_ = y;
    waiting_ = 0;
    joints_ = 0;
    wrapped_ = false;
  }

  [[gnu::always_inline]] void learn(const Sample& y) noexcept {
    rules_.learn(last_, y, h());
    speed_.learn(last_, y);
  }

  template <class Wrong>
  std::uint8_t which(Wrong wrong) const noexcept {
    int mask = 0;
    for (int j = 0; j < N; ++j) mask |= wrong(j) ? 1 << j : 0;
    return static_cast<std::uint8_t>(mask);
  }

  [[gnu::noinline]] Status judge(const Sample& y) noexcept {
    const Status status = judged(y);
    watch_ = jumped_ != 0 || stillness_.any() || speed_.any();
    return status;
  }

  [[gnu::always_inline]] Status judged(const Sample& y) noexcept {
    const auto readable = [](double x) { return std::abs(x) <= kMeasurementLimit; };
    joints_ = which(
        [&](int j) { return !readable(y.q[j]) || !readable(y.qd[j]) || !readable(y.tau[j]); });
    if (joints_ != 0) return Status::kBadMeasurement;
    joints_ = which([&](int j) { return !rules_.inside(y, j); });
    if (joints_ != 0) return Status::kOutOfRange;
    joints_ =
        stillness_.frozen(last_, y, [&](int j) { return rules_.calm(last_, y, y.t - last_.t, j); });
    joints_ |= speed_.frozen(last_, y);
    if (joints_ != 0) return Status::kFrozen;
    const Clock before = clock_;
    const Status time = clock_.accept(y.t);
    if (time != Status::kOk) return time == Status::kStarted ? start(y) : time;
    const Status status = judge_step(y);
    if (!used(status)) clock_ = before;
    return status;
  }

  Status start(const Sample& y) noexcept {
    stillness_.go_on(last_, y, [](int) { return false; });
    speed_.go_on(last_, y, true);
    remember(y);
    jumped_ = kFresh;
    return Status::kStarted;
  }

  // what came h() after the last one
  Status judge_step(const Sample& y) noexcept {
    Sample from = last_;
    for (int j = 0; j < N; ++j)
      turns_[j] =
          kTurn * (rules_.limits().turns >> j & 1) * std::round((y.q[j] - last_.q[j]) / kTurn);
    from.q += turns_;
    const auto leaps = which([&](int j) { return !rules_.continuous(from, y, h(), j); });
    const auto jumps = which([&](int j) { return !rules_.smooth(last_.tau[j], y.tau[j], j); });
    auto jolts = which([&](int j) { return !rules_.calm(last_, y, h(), j); });
    if (torque_ == TorqueSampling::kInstant) jolts |= jumps;
    learn(y);
    joints_ = leaps | jolts;
    if (jumped_ == kFresh && (joints_ | jumps) != 0) return start(y);
    if (joints_ == 0 || (leaps == 0 && borne_out(y))) return go_on(y, jumps);
    const double h = y.t - waits_.t;
    const auto strays = which([&](int j) { return !rules_.continuous(waits_, y, h, j); });
    waiting_ = waiting_ > 0 && h > 0 && strays == 0 ? waiting_ + 1 : 1;
    waits_ = y;
    return waiting_ < kClockSamples ? Status::kJump : start(y);
  }

  // whether the sample before has jumped as y has
  bool borne_out(const Sample& y) const noexcept {
    const double h = y.t - waits_.t;
    const auto other = [](double last, double before, double now, double limit) {
      return std::abs(now - before) > limit + std::abs(before - last);
    };
    return waiting_ > 0 &&
           which([&](int j) {
             return other(last_.qd[j], waits_.qd[j], y.qd[j], rules_.most(h, j)) ||
                    (torque_ == TorqueSampling::kInstant &&
                     other(last_.tau[j], waits_.tau[j], y.tau[j], rules_.limits().dtau[j]));
           }) == 0;
  }
  // y, whose tau has jumped at these joints
  Status go_on(const Sample& y, std::uint8_t jumps) noexcept {
    stillness_.go_on(last_, y, [&](int j) { return rules_.calm(last_, y, h(), j); });
    speed_.go_on(last_, y, !turns_.isZero(0));
    const auto back = which(
        [&](int j) { return (jumped_ & jumps) >> j & 1 && rules_.smooth(held_[j], y.tau[j], j); });
    for (int j = 0; j < N; ++j) last_.tau[j] = back >> j & 1 ? held_[j] : last_.tau[j];
    remember(y);
    joints_ = back | which([&](int j) { return turns_[j] != 0; });
    wrapped_ = joints_ != back;
    jumped_ = jumps & ~back;
    return Status::kOk;
  }

  Clock clock_;
  detail::Rules<P> rules_;
  Sample last_;  // that was used
  TorqueSampling torque_;
  Vec<P> held_ = Vec<P>::Zero();  // [N m] tau of the one before
  Vec<P> turns_ = held_;          // [rad] by which q has wrapped, if it has
  Sample waits_;                  // that jumped, waiting_ in a row
  int waiting_ = 0;
  Stillness<N, P> stillness_;
  StillSpeed<N, P> speed_;
  std::uint8_t joints_ = 0;   // of the verdict
  std::uint16_t jumped_ = 0;  // whose tau has then; or kFresh
  bool wrapped_ = false;      // q, at the last sample
  bool doubted_ = false;      // a filter the last sample
  bool watch_ = false;        // the next sample has to be judged, too
};

}  // namespace tauext
