// SPDX-License-Identifier: Apache-2.0
/// @file
/// Reference motions, in closed form.
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

namespace tauext {

/// A reference motion at one time: of a joint in rad, or of a hand in m.
struct Reference {
  double q = 0;    ///< [rad]
  double qd = 0;   ///< [rad/s]
  double qdd = 0;  ///< [rad/s^2]
};

/// amplitude sin(w t), w in rad/s.
Reference sine_motion(double amplitude, double w, double t);

/// The load of Fig. 6: 10 sin t + 5 cos(2t + pi/2) - 5 [N m].
double paper_sine(double t);

/// A sine of amplitude 1 between two times [s] whose frequency grows from 0.5 to 300 rad/s, as
/// quickly as itself, faded in and out, so that it begins and ends at rest.
double swept_sine(double t, double from = 2, double to = 38);

/// From rest to rest with the least jerk, as a human arm moves (Flash and Hogan 1985).
struct MinimumJerk {
  double begin = 0, duration = 1;  ///< [s]
  double from = 0, to = 0;         ///< [rad] or [m]
};

/// From rest to rest with a trapezium of velocity, as a motor is told to.
struct Trapezium {
  double begin = 0;         ///< [s]
  double from = 0, to = 0;  ///< [rad]
  double speed = 0.2;       ///< [rad/s] largest
  double acceleration = 1;  ///< [rad/s^2]

  double duration() const;  ///< [s]
};

/// Where a move is at time t [s]; it is at rest before and after.
Reference reference_at(const MinimumJerk& m, double t);
/// Where a move is at time t [s]; it is at rest before and after.
Reference reference_at(const Trapezium& m, double t);

/// One move after the other, at rest before, between and after them.
template <class Move>
class Moves {
 public:
  /// @param moves in the order of time, each from where the last one ended; not empty
  explicit Moves(std::vector<Move> moves) : moves_(std::move(moves)) {}

  /// At time t [s]; every joint's.
  Reference operator()(double t, int = 0) const {
    // the last one that has begun
    std::size_t i = moves_.size() - 1;
    while (i > 0 && moves_[i].begin > t) --i;
    return reference_at(moves_[i], t);
  }

 private:
  std::vector<Move> moves_;
};

}  // namespace tauext
