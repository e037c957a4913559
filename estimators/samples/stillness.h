// SPDX-License-Identifier: Apache-2.0
/// @file
/// Frozen sensors. A joint stands still if its q is the same as before to the last bit, although qd
/// says that it moves. It is frozen at once if qd is the same, too, else after 0.5 mrad of the
/// motion that qd tells of. An encoder may have steps of up to 2.5 mrad, which are learnt where a
/// joint stands still a second time: then it is frozen after twice that.
///
/// The other way round, a joint's speed stands still if qd is the same as before to the last bit,
/// although q moves. It is frozen where q has gone 0.5 mrad from where qd leads, by more than
/// 0.02 rad/s in the mean; a qd may have steps of up to 0.2 rad/s, which are learnt likewise: then
/// by more than twice that. If qd has changed 200 times and not repeated itself, three repetitions
/// are enough, but of 0, which some say of any slow motion; until that is known to be how this
/// sensor speaks: it leads where q goes within 0.1 mrad/s for 0.25 s, or, for the next 10,000
/// changes, it has been said once.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "estimators/types.h"

namespace tauext {

inline constexpr double kStillMotion = 1e-4;  ///< [rad] in a step, with another qd

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
    const bool same = b.q[j] == a.q[j], same_speed = b.qd[j] == a.qd[j];
    const bool moves = b.qd[j] != 0, moves_far = h * std::abs(b.qd[j]) > kStillMotion;
    return same & moves & (same_speed | moves_far);
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

/// Which of the first N joints have a frozen qd; samples have room for P.
template <int N, int P>
class StillSpeed {
 public:
  /// Of a sensor that nothing is known of.
  void reset() noexcept {
    still_ = stepped_ = frozen_ = 0;
    step_.setZero();
    changes_.setZero();
  }

  /// Whether joint j repeats its qd at b, h [s] after a, and moves.
  [[gnu::always_inline]] static bool still(const Measurement<P>& a, const Measurement<P>& b,
                                           double h, int j) noexcept {
    const bool same_speed = b.qd[j] == a.qd[j], moved = b.q[j] != a.q[j];
    const bool moves = b.qd[j] != 0, moved_far = std::abs(b.q[j] - a.q[j]) > h * kSlow;
    return same_speed & moved & (moves | moved_far);
  }

  /// Whether a joint's speed stood still at the last sample.
  bool any() const noexcept { return still_ != 0; }

  /// b is used after a.
  [[gnu::always_inline]] void learn(const Measurement<P>& a, const Measurement<P>& b) noexcept {
    for (int j = 0; j < P; ++j) changes_[j] += b.qd[j] != a.qd[j] ? 1 : 0;
  }

  /// How often each joint's qd has changed since it last repeated itself: all that learn() changes.
  Vec<P>& changes() noexcept { return changes_; }

  /// The joints frozen at b, bit 0 for the first. One leap of q makes none.
  std::uint8_t frozen(const Measurement<P>& a, const Measurement<P>& b) noexcept {
    int mask = 0;
    for (int j = 0; still_ != 0 && j < N; ++j) {
      if (!(still_ >> j & 1)) continue;
      const Run r = run(a, b, j);
      const double most = kTravel + std::max(kSlow, 2 * step_[j]) * r.time;
      const bool astray = std::abs(run_[j].way) > kTravel / 2 && std::abs(r.way) > most;
      const bool leads = r.time >= kLong && std::abs(r.way) <= kLeads * r.time;
      const bool odd = changes_[j] >= kFew && r.count >= 3 && b.qd[j] != 0 && !leads;
      mask |= (astray || odd) << j;
    }
    frozen_ |= static_cast<std::uint8_t>(mask);
    return static_cast<std::uint8_t>(mask);
  }

  /// b is used after a, or at a start.
  void go_on(const Measurement<P>& a, const Measurement<P>& b, bool start) noexcept {
    int mask = 0;
    for (int j = 0; j < N; ++j) {
      if (still_ >> j & 1) know(a, b, j);
      run_[j] = start ? Run{} : run(a, b, j);
      mask |= (run_[j].count > 0) << j;
    }
    still_ = static_cast<std::uint8_t>(mask);
    frozen_ = 0;
  }

 private:
  static constexpr double kTravel = 5e-4;  // [rad] from where qd leads
  static constexpr double kSlow = 0.02;    // [rad/s] that a speed may be off
  static constexpr double kCoarse = 0.2;   // [rad/s] of a step of qd
  static constexpr double kLeads = 1e-4;   // [rad/s] off, of a qd that leads where q goes
  static constexpr double kLong = 0.25;    // [s] to know it
  static constexpr double kFew = 200;      // changes, of a sensor that does not repeat itself
  static constexpr double kMany = 10000;   // changes, until one that did is believed to be such

  // since qd stands still
  struct Run {
    double way = 0;   // [rad] of q, beyond where qd leads
    double time = 0;  // [s]
    int count = 0;    // of samples
  };
  Run run(const Measurement<P>& a, const Measurement<P>& b, int j) const noexcept {
    const double h = b.t - a.t;
    const bool on = still_ >> j & 1;
    if (!(h > 0) || b.qd[j] != a.qd[j] || !(on || still(a, b, h, j))) return {};
    const Run before = on ? run_[j] : Run{};
    return {before.way + b.q[j] - a.q[j] - h * b.qd[j], before.time + h, before.count + 1};
  }

  // what the end of a run says of a sensor, or that it goes on although it was called frozen
  void know(const Measurement<P>& a, const Measurement<P>& b, int j) noexcept {
    const double change = std::abs(b.qd[j] - a.qd[j]);
    const bool frozen = frozen_ >> j & 1, odd = changes_[j] >= kFew;
    if (change > 0 && change <= kCoarse && !(frozen && odd)) {
      if (stepped_ >> j & 1) step_[j] = step_[j] > 0 ? std::min(step_[j], change) : change;
      stepped_ |= static_cast<std::uint8_t>(1 << j);
    }
    if (frozen) changes_[j] = -kMany;
    if (!frozen && change > 0) changes_[j] = std::min(changes_[j], 0.);
  }

  std::array<Run, N> run_;        // of joints whose speed stands still
  Vec<P> step_ = Vec<P>::Zero();  // [rad/s] of their qd
  Vec<P> changes_ = step_;        // of qd, since it last repeated itself
  std::uint8_t still_ = 0;        // at the last sample
  std::uint8_t stepped_ = 0;      // once at least
  std::uint8_t frozen_ = 0;       // since the last sample that was used
};

}  // namespace tauext
