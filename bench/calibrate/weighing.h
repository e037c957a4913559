// SPDX-License-Identifier: Apache-2.0
/// @file
/// Mass and center of mass of what an arm carries behind its end effector's joint, from recordings
/// in which nothing touches it.
///
/// (ii) of arm_motion.h, of all joints that move, with a payload's mass m and first moments m c in
/// the place of friction: it is linear in them, but for the payload's own inertia, which is taken
/// as that of a point. What the arm's model has wrong is the same with and without the payload:
/// the answer from recordings without it is taken off.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "bench/calibrate/windows.h"
#include "mjcf/plant/tree.h"
#include "mjcf/trace/trace.h"

namespace tauext {

/// A weight, in the axes of the body that carries it, from its origin.
struct Weight {
  double mass = 0;                                         ///< [kg]
  double mass_error = 0;                                   ///< [kg] one standard error
  Eigen::Vector3d moment = Eigen::Vector3d::Zero();        ///< [kg m] mass times center of mass
  Eigen::Vector3d moment_error = Eigen::Vector3d::Zero();  ///< [kg m] likewise
  double residual = 0;  ///< [N m] rms that is left, over all joints
  int windows = 0;      ///< of all joints
};

/// What recordings say of a payload.
struct Weighing {
  std::string body;  ///< that carries it
  Weight loaded;     ///< seen with it
  Weight empty;      ///< seen without it; 0 if there are no such recordings
  Weight payload;    ///< the difference, with both errors
  Eigen::Vector3d center = Eigen::Vector3d::Zero();        ///< [m] of its mass
  Eigen::Vector3d center_error = Eigen::Vector3d::Zero();  ///< [m] likewise
};

/// @param arm with its friction, and without the payload
/// @param empty may have no recording
/// @throws std::invalid_argument for another number of joints, too few windows, or motions that do
/// not show the weight
Weighing weigh(const ArmTree& arm, const std::vector<Trace>& loaded,
               const std::vector<Trace>& empty, const Windows& windows = {});

/// Why a payload is not to be used, as it weighs less than nothing by more than an error of
/// measurement; else "".
std::string doubt(const Weighing& w);

}  // namespace tauext
