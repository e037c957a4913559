// SPDX-License-Identifier: Apache-2.0
/// @file
/// What nobody's file knows of an arm's joints, from recordings without contact: friction, the
/// rotors' inertia, the offsets of the torque sensors and the gains of the drives.
///
/// The masses are those of the arm's file. Joint by joint, over windows in which the joint moves
/// one way (windows.h),
///     mean(tau) - (ii) without these terms = armature mean(qdd) + coulomb mean(sign) + ..
/// by linear least squares; where the log has currents i, mean(i) = that / gain, likewise. A
/// parameter's error is the larger of the robust one (Newey and West) and of a jackknife over ten
/// stretches of the recordings, which sees what drifts from one to the next. What no recording
/// without contact can tell: a factor on all torques from the same factor on all masses, friction
/// and rotors; and an offset from a Coulomb friction that differs by the direction.
#pragma once

#include <string>
#include <vector>

#include "bench/calibrate/joint_fit.h"
#include "bench/calibrate/windows.h"
#include "mjcf/plant/tree.h"
#include "mjcf/trace/trace.h"

namespace tauext {

/// How to calibrate.
struct CalibrateOptions {
  std::vector<std::string> terms;  ///< of them; none: all
  Windows windows;                 ///< of the logs
  bool scale = false;              ///< whether torques are multiplied by their scale
};

/// The name of a coordinate's joint in a robot file: its own, or what the import calls it.
std::string joint_name_in_file(const ArmTree& arm, int coordinate);

/// @throws std::invalid_argument for an arm whose coordinates mix joints
void require_own_joints(const ArmTree& arm);

/// @param arm of which is left aside what is to be found: the joints' armature, and all of their
/// friction and offset if any of these is
/// @throws std::invalid_argument for an unknown term, an arm whose coordinates mix joints, another
/// number of joints, currents and torques together, too few windows, a gain that cannot be seen, or
/// a motion that cannot tell the terms apart: naming the joint, the term and the remedy
std::vector<CalibratedJoint> calibrate_arm(const ArmTree& arm, const std::vector<Trace>& logs,
                                           const CalibrateOptions& options = {});

}  // namespace tauext
