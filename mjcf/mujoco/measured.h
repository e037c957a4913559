// SPDX-License-Identifier: Apache-2.0
/// @file
/// What somebody measured of a joint that MJCF has no attribute for.
#pragma once

#include "mjcf/mujoco/handles.h"

namespace tauext {

/// It stands in `custom` as a `numeric` called `tauext:JOINT`, with the joint's name, whose data
/// are offset, viscous_skew, gain and torque_gain; what is missing is 0.
struct Measured {
  double offset = 0;        ///< [N m] or [N] that tau is always too large by
  double viscous_skew = 0;  ///< [N m s/rad] more friction where qd > 0, less where qd < 0
  double gain = 0;          ///< [N m/A] or [N/A] of the drive; 0: nobody knows
  double torque_gain = 0;   ///< [1] of the torques of logs; 0: nobody knows
};

/// @param joint its number, from 0
Measured measured(const mjModel& m, int joint);

/// What the drive of a joint can do at most; 0 where the file does not say.
struct Rated {
  double torque = 0;  ///< [N m] or [N]
  double speed = 0;   ///< [rad/s] or [m/s]
};

/// Both numbers of `custom`'s `numeric` called `tauext:rated:JOINT`; where the torque is 0 there,
/// that of the ranges of its motors.
Rated rated_of(const mjModel& m, int joint);

}  // namespace tauext
