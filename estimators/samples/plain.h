// SPDX-License-Identifier: Apache-2.0
/// @file
/// Which samples are plain: those that an arm can have made since the last one, by the rules of
/// sampling.h, and so need no more looking at.
#pragma once

#include <algorithm>
#include <cmath>
#include <type_traits>

#include "estimators/math/lanes.h"
#include "estimators/samples/limits.h"
#include "estimators/samples/stillness.h"
#include "estimators/types.h"

namespace tauext::detail {

/// The rules for samples of N joints, of one arm or, with a Pack, of several, and what is usual.
template <int N, class Scalar = double>
class Rules {
  using Truth = decltype(Scalar() < Scalar());

 public:
  using Sample = Measurement<N, Scalar>;  ///< of the sensors

  explicit Rules(const ArmLimits<N>& limits) : limits_(limits) {}  ///< of this arm

  const ArmLimits<N>& limits() const noexcept { return limits_; }  ///< of the arm

  /// (i)
  [[gnu::always_inline]] static Truth continuous(const Sample& a, const Sample& b, const Scalar& h,
                                                 int j) noexcept {
    using std::abs;
    return abs(b.q[j] - a.q[j] - 0.5 * h * (b.qd[j] + a.qd[j])) <= 0.005 + 8 * h * abs(a.qd[j]);
  }
  /// The right side of (ii).
  [[gnu::always_inline]] Scalar most(const Scalar& h, int j) const noexcept {
    return 0.02 + h * limits_.qdd[j] + 6 * usual[j];
  }
  /// (ii)
  [[gnu::always_inline]] Truth calm(const Sample& a, const Sample& b, const Scalar& h,
                                    int j) const noexcept {
    using std::abs;
    return abs(b.qd[j] - a.qd[j]) <= most(h, j);
  }
  /// Whether tau [N m] may go from a to b at once.
  [[gnu::always_inline]] Truth smooth(const Scalar& a, const Scalar& b, int j) const noexcept {
    using std::abs;
    return abs(b - a) <= limits_.dtau[j];
  }
  /// Whether joint j is inside its limits.
  [[gnu::always_inline]] Truth inside(const Sample& y, int j) const noexcept {
    using std::abs;
    // names, as in all that follow: with calls, clang takes & of two bools for a mistake
    const Truth least = y.q[j] >= limits_.q_least[j], most = y.q[j] <= limits_.q_most[j];
    const Truth slow = abs(y.qd[j]) <= limits_.qd[j], weak = abs(y.tau[j]) <= limits_.tau[j];
    return least & most & slow & weak;
  }

  /// Whether all joints of all arms are so at b, h [s] after a.
  [[gnu::always_inline]] bool plain(const Sample& a, const Sample& b,
                                    const Scalar& h) const noexcept {
    if constexpr (std::is_same_v<Scalar, double>) {
      double others = 0;  // not an integer: a compiler takes four joints at once then
      for (int j = 0; j < N; ++j) {
        const bool ok = plain(a, b, h, j);
        others += ok ? 0 : 1;
      }
      return others == 0;
    } else {
      Truth ok = plain(a, b, h, 0);
      for (int j = 1; j < N; ++j) ok = ok & plain(a, b, h, j);
      return all(ok);
    }
  }

  /// Takes from b, h [s] after a, what is usual: the mean of |qd_k - qd_k-1| over
  /// some 64 samples, to which an outlier adds little.
  [[gnu::always_inline]] void learn(const Sample& a, const Sample& b, const Scalar& h) noexcept {
    using std::abs;
    using std::min;
    for (int j = 0; j < N; ++j) {
      const Scalar change = abs(b.qd[j] - a.qd[j]);
      usual[j] += 0x1p-6 * (min(change, Scalar(most(h, j) - 4 * usual[j])) - usual[j]);
    }
  }

  Vec<N, Scalar> usual = Vec<N, Scalar>::Zero();  ///< [rad/s] change of qd from sample to sample

 private:
  [[gnu::always_inline]] Truth plain(const Sample& a, const Sample& b, const Scalar& h,
                                     int j) const noexcept {
    const Truth is_inside = inside(b, j), goes_on = continuous(a, b, h, j);
    const Truth is_calm = calm(a, b, h, j), is_smooth = smooth(a.tau[j], b.tau[j], j);
    const Truth moves = !stands(a, b, h, j);
    return is_inside & goes_on & is_calm & is_smooth & moves;
  }
  // whether a joint may stand still, by either rule
  [[gnu::always_inline]] static Truth stands(const Sample& a, const Sample& b, const Scalar& h,
                                             int j) noexcept {
    using std::abs;
    const Truth same = b.q[j] == a.q[j], same_speed = b.qd[j] == a.qd[j];
    const Truth moves = b.qd[j] != Scalar(0), moves_far = h * abs(b.qd[j]) > kStillMotion;
    return (same_speed & ((!same) | moves)) | (same & moves_far);
  }

  ArmLimits<N> limits_;
};

}  // namespace tauext::detail
