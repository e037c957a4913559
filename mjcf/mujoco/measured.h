// SPDX-License-Identifier: Apache-2.0
/// @file
/// What somebody measured of a joint that MJCF has no attribute for.
#pragma once

#include "mjcf/mujoco/handles.h"

namespace tauext {

/// It stands in `custom` as a `numeric` called `tauext:JOINT`, with the joint's name, whose data
/// are offset, viscous_skew and gain; what is missing is 0.
struct Measured {
  double offset = 0;        ///< [N m] or [N] that tau is always too large by
  double viscous_skew = 0;  ///< [N m s/rad] more friction where qd > 0, less where qd < 0
  double gain = 0;          ///< [N m/A] or [N/A] of the drive; 0: nobody knows
};

/// @param joint its number, from 0
Measured measured(const mjModel& m, int joint);

/// [N m] or [N] what the drive of a joint can do at most: `custom`'s `numeric` called
/// `tauext:rated:JOINT`, or else the ranges of its motors; 0 where the file does not say.
double rated_torque(const mjModel& m, int joint);

}  // namespace tauext
