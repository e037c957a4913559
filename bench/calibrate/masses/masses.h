// SPDX-License-Identifier: Apache-2.0
/// @file
/// Masses, centers of mass and inertias of an arm's bodies from recordings without contact.
///
/// (ii) of arm_motion.h with the bodies' numbers (body_terms.h) beside each joint's terms
/// (joint_fit.h), of all joints at once, each by the inverse of what is left of its torque; with
/// instruments (least_squares.h) for what acceleration is in; near the masses of the arm's file, or
/// near bodies of a likely size where it has none, in what the recordings do not show
/// (physical_fit.h). Ten stretches of the recordings, each left out once, say what holds of motions
/// that the fit has not seen. What no motion can tell: single masses, as the torques show
/// combinations of them only; and a factor on all of them from one on all torques.
#pragma once

#include <Eigen/Core>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "bench/calibrate/masses/base_parameters.h"
#include "bench/calibrate/robot_file_writer.h"
#include "bench/calibrate/windows.h"
#include "mjcf/trace/trace.h"

namespace tauext {

/// A body that a joint moves, before and after.
struct IdentifiedBody {
  std::string name;         ///< as the file has it
  bool known = true;        ///< whether the file has a mass of it
  MeasuredBody file;        ///< if so
  MeasuredBody identified;  ///< near `file` in what the recordings do not show
};

/// What the masses are good for, joint by joint.
struct JointOfMasses {
  std::string name;     ///< fit to be printed
  double torque = 0;    ///< [N m] rms of the measured torque
  double nominal = 0;   ///< [N m] rms that the file's masses leave, of stretches not seen; or 0
  double held_out = 0;  ///< [N m] the same of the identified ones
  double gravity_error = 0;  ///< [N m] rms, one standard error of the torque that holds the arm, in
                             ///< poses of all of its range
  double inertia_error = 0;  ///< [kg m^2] likewise, of what it turns with its rotor
};

/// All of it.
struct IdentifiedMasses {
  std::vector<IdentifiedBody> bodies;  ///< all that joints move
  std::vector<JointOfMasses> joints;   ///< in the arm's order
  BaseParameters base;                 ///< of these bodies
  bool has_nominal = false;            ///< whether the file has all masses
  double scale = 1;                 ///< [1] the identified gravity torques by the file's; if known
  bool differs_by_scale = false;    ///< whether these torques are else much like the file's
  std::vector<std::string> doubts;  ///< why these numbers are not to be used; else none
};

/// Finds them, and fills robot.bodies and robot.joints, which judge_by_file() looks at afterwards.
/// @param arm of robot.from
/// @param massless bodies of it whose masses its file does not have
/// @throws std::invalid_argument for an arm whose coordinates mix joints, a body without a name, a
/// file with a payload, another number of joints, currents, or too few windows, naming the remedy
IdentifiedMasses identify_masses(const ArmTree& arm, const std::set<std::string>& massless,
                                 const std::vector<Trace>& logs, const Windows& windows,
                                 NewRobotFile& robot);

}  // namespace tauext
