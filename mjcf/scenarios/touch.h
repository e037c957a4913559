// SPDX-License-Identifier: Apache-2.0
/// @file
/// How the outside touches an arm at its end effector: blows, pushes, clampings, one by one or
/// drawn at random. The forces are prescribed, in the plane of x and z.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <vector>

#include "mjcf/scenarios/scenario_type.h"

namespace tauext {

/// [s] of the first drawn touch: estimators have settled by then, with an unknown panel, too.
inline constexpr double kFirstTouch = 4;

/// What a touch is.
enum class TouchKind : std::uint8_t {
  kBlow,       ///< a half sine of 10 to 50 ms, 100 to 300 N: a collision
  kSlowPush,   ///< a human's push: minimum jerk to 30 to 80 N in 0.8 to 2 s, held, and back
  kBriskPush,  ///< a push on purpose that is as fast as some blows: 100 N in 0.1 s, held, and back
  kClamp,      ///< something soft is caught: a straight line to 200 N in 0.5 to 1 s, held for 2 s
};

/// One touch.
struct Touch {
  TouchKind kind = TouchKind::kBlow;                ///< what it is
  double begin = 0;                                 ///< [s]
  double rise = 0.02;                               ///< [s] of a blow: all of it
  double hold = 0;                                  ///< [s]
  double fall = 0;                                  ///< [s]
  Eigen::Vector3d force = Eigen::Vector3d::Zero();  ///< [N] at its largest, on the arm, world frame

  double end() const { return begin + rise + hold + fall; }    ///< [s]
  bool on(double t) const { return t >= begin && t < end(); }  ///< whether it acts at t [s]
  /// [N] at time t.
  Eigen::Vector3d operator()(double t) const;
};

/// A motion for studies, quick as that of a working arm, about `home` by up to `reach` [rad or m]
/// of each joint: at up to 2 rad/s, from place to place by minimum jerk with rests of 0.2 to 1 s.
/// For training otherwise: by sines of acceleration, and for every other seed by sums of two sines.
std::function<Reference(double, int)> brisk_motion(const Eigen::VectorXd& home,
                                                   const Eigen::VectorXd& reach, std::uint64_t seed,
                                                   bool training);

/// Touches of one kind, one after the other, at random times, directions and sizes within the
/// ranges of TouchKind, all between `from` and `until` [s]; 1 to 2 s apart, clampings 2 to 3 s.
std::vector<Touch> draw_touches(TouchKind kind, std::uint64_t seed, double from, double until);

/// The scenario with these forces on its end effector. `contact` says where a blow or a clamping
/// acts.
Scenario with_touches(Scenario scenario, const std::vector<Touch>& touches);

/// A run of wallmobot3 for studies: q_ref of 0.05 to 0.1 rad and 0.5 to 1 rad/s as the seed draws
/// them, 30 s, with touches of one kind from 4 s on. The panel and the rest of the robot are the
/// model's.
Scenario touched_wallmobot3(TouchKind kind, std::uint64_t seed);

/// The touches in that run.
std::vector<Touch> touches_of_wallmobot3(TouchKind kind, std::uint64_t seed);

}  // namespace tauext
