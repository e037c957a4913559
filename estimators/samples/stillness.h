// SPDX-License-Identifier: Apache-2.0
/// @file
/// Frozen sensors. A joint stands still if its q is the same as before to the last bit, although qd
/// says that it moves. It is frozen at once if qd is the same, too, else after 0.5 mrad of the
/// motion that qd tells of. An encoder may have steps of up to 2.5 mrad, which are learnt where a
/// joint stands still a second time: then it is frozen after twice that.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "estimators/types.h"

namespace tauext {

/// Which of the first N joints are frozen; samples have room for P.
template <int N, int P>
class Stillness {
 public:
  /// Of a sensor that nothing is known of.
  void reset() noexcept {
    still_ = stepped_ = 0;
    step_.setZero();
  }

  /// Whether joint j says at b, h [s] after a, that it moves, and stands still.
  [[gnu::always_inline]] static bool still(const Measurement<P>& a, const Measurement<P>& b,
                                           double h, int j) noexcept {
    return (b.q[j] == a.q[j]) & (b.qd[j] != 0) &
           ((b.qd[j] == a.qd[j]) | (h * std::abs(b.qd[j]) > kMotion));
  }

  /// Whether joints stood still at the last sample.
  bool any() const noexcept { return still_ != 0; }

  /// The joints frozen at b, bit 0 for the first; calm(j): its qd has not jumped.
  template <class Calm>
  std::uint8_t frozen(const Measurement<P>& a, const Measurement<P>& b, Calm calm) noexcept {
    int mask = 0;
    for (int j = 0; j < N; ++j) {
      const bool repeated = b.qd[j] == a.qd[j] && step_[j] == 0;
      const double most = repeated ? kRepeated : std::max(kTravel, 2 * step_[j]);
      mask |= (calm(j) && std::abs(travel(a, b, j)) > most) << j;
    }
    for (int j = 0; mask != 0 && j < N; ++j) travel_[j] *= still_ >> j & 1;
    still_ |= static_cast<std::uint8_t>(mask);  // the step that ends it is learnt
    return static_cast<std::uint8_t>(mask);
  }

  /// b is used after a, or, with nothing before it, at a start.
  template <class Calm>
  void go_on(const Measurement<P>& a, const Measurement<P>& b, Calm calm) noexcept {
    int mask = 0;
    for (int j = 0; j < N; ++j) {
      const double change = std::abs(b.q[j] - a.q[j]);
      if (still_ >> j & 1 && change > 0 && change <= kCoarse) {
        if (stepped_ >> j & 1) step_[j] = std::max(step_[j], change);
        stepped_ |= static_cast<std::uint8_t>(1 << j);
      }
      travel_[j] = calm(j) ? travel(a, b, j) : 0;
      mask |= (travel_[j] != 0) << j;
    }
    still_ = static_cast<std::uint8_t>(mask);
  }

 private:
  static constexpr double kTravel = 5e-4;    // [rad] with q the same
  static constexpr double kRepeated = 1e-6;  // [rad] and qd; an arm at rest says so to 1e-17
  static constexpr double kMotion = 1e-4;    // [rad] in a step, if qd differs
  static constexpr double kCoarse = 2.5e-3;  // [rad] of an encoder's step

  // [rad] that a joint says to have moved since its q changed
  double travel(const Measurement<P>& a, const Measurement<P>& b, int j) const noexcept {
    const double h = b.t - a.t;
    return !(h > 0) || !still(a, b, h, j) ? 0 : (still_ >> j & 1 ? travel_[j] : 0) + h * b.qd[j];
  }

  Vec<P> travel_ = Vec<P>::Zero();        // [rad] of joints that stand still
  Vec<P> step_ = travel_;                 // [rad] of their encoders
  std::uint8_t still_ = 0, stepped_ = 0;  // at the last sample; once at least
};

}  // namespace tauext
