// SPDX-License-Identifier: Apache-2.0
/// @file
/// What Sampling is for several runs at once. It knows plain samples (samples/plain.h) alone.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <tuple>
#include <utility>

#include "estimators/math/pack.h"
#include "estimators/sampling.h"

namespace tauext {

/// The plain samples of W runs of N joints. Those that are not go to the Sampling of each run.
template <int N, int W>
class Sampling<N, Pack<W>> {
  using Scalar = Pack<W>;

 public:
  using Sample = Measurement<N, Scalar>;  ///< of all runs
  static constexpr int kSpan = 8;  ///< samples that are kept: fewer copies, a longer way back

  /// As of one run.
  explicit Sampling(double max_gap, const ArmLimits<N>& limits = {},
                    TorqueSampling torque = TorqueSampling::kHeld)
      : max_gap_(max_gap), rules_(limits), torque_(torque) {}

  /// Looks at the next sample.
  /// @returns whether it is plain in all runs; if not, nothing has changed
  [[gnu::always_inline]] bool look(const Sample& y) noexcept {
    h_ = y.t - last().t;
    return !watches_ && all((h_ > Scalar(0)) & (h_ <= limit_)) && rules_.plain(last(), y, h_);
  }
  /// The sample that was looked at, and is plain, is used.
  [[gnu::always_inline]] void take(const Sample& y) noexcept {
    typical_ += 0.125 * (h_ - typical_);
    limit_ = min(Scalar(max_gap_), 8 * typical_);
    rules_.learn(last(), y, h_);
    for (int j = 0; j < N; ++j)
      changes_[j] += select(y.qd[j] != last().qd[j], Scalar(1), Scalar(0));
    samples_[static_cast<std::size_t>(++taken_)] = y;
    settled_ = true;
  }

  /// Samples taken since keep(); at most kSpan.
  int taken() const noexcept { return taken_; }
  /// Sample i of them, from 1.
  const Sample& sample(int i) const noexcept { return samples_[static_cast<std::size_t>(i)]; }
  /// Forgets them, but the last one.
  void keep() noexcept {
    if (taken_ == 0) return;
    held_ = sample(taken_ - 1).tau;
    samples_[0] = last();
    taken_ = 0;
  }
  /// Before runs are at samples of their own.
  /// @returns whether plain ones have come since the last time
  bool part() noexcept {
    keep();
    watches_ = false;
    return std::exchange(settled_, false);
  }
  /// A run has to judge the next sample.
  void watch() noexcept { watches_ = true; }
  /// What a Sampling of doubles lists; after keep().
  auto memory() noexcept {
    Sample& y = samples_[0];
    return std::tie(typical_, limit_, y.t, y.q, y.qd, y.tau, held_, rules_.usual, changes_);
  }

  // what an estimator asks between look() and take()

  /// kOk: look() has been asked.
  Status accept(const Sample&) const noexcept { return Status::kOk; }
  /// kUnlikely where some joint of some run is.
  Status confirm(std::uint8_t unlikely) const noexcept {
    return unlikely != 0 ? Status::kUnlikely : Status::kOk;
  }
  /// As of one run.
  [[gnu::always_inline]] Vec<N, Scalar> torque(const Sample& y) const noexcept {
    return torque_ == TorqueSampling::kHeld ? torque_before()
                                            : Vec<N, Scalar>(0.5 * (torque_before() + y.tau));
  }
  const Vec<N, Scalar>& torque_before() const noexcept { return last().tau; }  ///< as of one run
  const Scalar& h() const noexcept { return h_; }  ///< [s] from the last sample to this one
  bool wrapped() const noexcept { return false; }  ///< no plain sample has
  /// [rad] none.
  Vec<N, Scalar> turns() const noexcept { return Vec<N, Scalar>::Zero(); }
  std::uint8_t joints() const noexcept { return 0; }  ///< that plain samples are about
  void reset() noexcept {}

 private:
  [[gnu::always_inline]] const Sample& last() const noexcept { return sample(taken_); }

  double max_gap_;
  detail::Rules<N, Scalar> rules_;
  TorqueSampling torque_;
  std::array<Sample, kSpan + 1> samples_;  // the last one of keep(), and those since
  int taken_ = 0;
  Scalar h_ = 0, typical_ = 0, limit_ = 0;        // as of a Clock
  Vec<N, Scalar> held_ = Vec<N, Scalar>::Zero();  // [N m] tau before samples_[0]
  Vec<N, Scalar> changes_ = held_;                // as of StillSpeed
  bool settled_ = false;                          // plain samples have come
  bool watches_ = false;
};

}  // namespace tauext
