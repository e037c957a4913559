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

#include "bench/calibrate/residuals.h"
#include "bench/calibrate/windows.h"
#include "mjcf/plant/tree.h"
#include "mjcf/trace/trace.h"

namespace tauext {

/// A term of a joint's torque.
struct JointTerm {
  const char* name;  ///< as in a robot file
  const char* unit;  ///< of a hinge
  const char* what;  ///< that it multiplies
  /// The same, of qd [rad/s], slip (tanh(qd / v_s)) and what the masses take [N m]; nullptr: qdd.
  double (*column)(double qd, double slip, double rigid);
};

/// Those that can be calibrated.
inline constexpr JointTerm kJointTerms[] = {
    {"armature", "kg m^2", "qdd", nullptr},
    {"coulomb", "N m", "sign(qd)", [](double, double slip, double) { return slip; }},
    {"viscous", "N m s/rad", "qd", [](double qd, double, double) { return qd; }},
    {"viscous_skew", "N m s/rad", "|qd|", [](double qd, double slip, double) { return qd * slip; }},
    {"offset", "N m", "1", [](double, double, double) { return 1.; }},
};

/// How to calibrate.
struct CalibrateOptions {
  std::vector<std::string> terms;  ///< of them; none: all
  Windows windows;                 ///< of the logs
};

/// [1] of a joint's torque that masses must take, rms, for its gain to be seen: else what a file
/// has wrong of a small mass is all that one sees.
inline constexpr double kSeen = 0.2;

/// A parameter of a joint.
struct CalibratedTerm {
  std::string name;       ///< as in kJointTerms
  double value = 0;       ///< in its unit
  double error = 0;       ///< [same] one standard error
  double excitation = 0;  ///< [N m] by unit: rms of what it multiplies
  double own = 0;         ///< [1] share of that which the other terms cannot imitate
};

/// What is known of a joint.
struct CalibratedJoint {
  std::string name;                   ///< in the arm's file
  std::vector<CalibratedTerm> terms;  ///< in the order that was asked for
  double gain = 0;                    ///< [N m/A] of the drive, from a log of currents; else 0
  double gain_error = 0;              ///< [N m/A] likewise
  /// [1] the factor on this joint's measured torques at which they fit the file's masses best; 0
  /// for currents, whose gain it is, and where these masses take less than kSeen of the torque
  double scale = 0;
  double scale_error = 0;        ///< [1] its robust error
  double rigid = 0;              ///< [N m] rms of what the file's masses take of the torque
  double torque = 0;             ///< [N m] rms of the measured torque
  double before = 0;             ///< [N m] rms that is left without any of these terms
  double after = 0;              ///< [N m] with them
  double held_out = 0;           ///< [N m] the same, of stretches that the fit has not seen
  double colour = 0;             ///< [1] of what is left (residuals.h)
  std::vector<Suspect> missing;  ///< what may be missing; the likeliest first
  int windows = 0;               ///< that were used
  int left_out = 0;              ///< that were not
};

/// The name of a coordinate's joint in a robot file: its own, or what the import calls it.
std::string joint_name_in_file(const ArmTree& arm, int coordinate);

/// @param arm of which is left aside what is to be found: the joints' armature, and all of their
/// friction and offset if any of these is
/// @throws std::invalid_argument for an unknown term, an arm whose coordinates mix joints, another
/// number of joints, currents and torques together, too few windows, a gain that cannot be seen, a
/// motion that cannot tell the terms apart, a torque or a dry friction of the wrong sign, or a fit
/// that leaves more than the torque that was measured: naming the joint, the term and the remedy
std::vector<CalibratedJoint> calibrate_arm(const ArmTree& arm, const std::vector<Trace>& logs,
                                           const CalibrateOptions& options = {});

}  // namespace tauext
