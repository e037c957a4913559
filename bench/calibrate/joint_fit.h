// SPDX-License-Identifier: Apache-2.0
/// @file
/// The parameters of one joint from its windows, and whether they are to be trusted.
///
/// Armature and friction below 0, which no joint has, are held at 0, and the others are fitted
/// again. Where that is more than an error of measurement, the recordings are not of this arm.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "bench/calibrate/least_squares.h"

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

/// [1] of a joint's torque that masses must take, rms, for its gain to be seen: else what a file
/// has wrong of a small mass is all that one sees.
inline constexpr double kSeen = 0.2;

/// [1] Torques that fit the masses by another factor are not those of this arm in N m: masses from
/// drawings and torque constants are each within a fifth or so.
inline constexpr double kLeastScale = 0.7;
inline constexpr double kMostScale = 1.4;  ///< [1] likewise

/// A parameter of a joint.
struct CalibratedTerm {
  std::string name;       ///< as in kJointTerms
  double value = 0;       ///< in its unit
  double error = 0;       ///< [same] one standard error; of one that is held, before it was
  double excitation = 0;  ///< [N m] by unit: rms of what it multiplies
  double own = 0;         ///< [1] share of that which the other terms cannot imitate
};

/// What is known of a joint.
struct CalibratedJoint {
  std::string name;                   ///< in the arm's file
  std::vector<CalibratedTerm> terms;  ///< in the order that was asked for
  double gain = 0;           ///< [N m/A] of the drive, of a log of currents; else [1], or 0: none
  double gain_error = 0;     ///< [same] its robust error
  double gain_before = 1;    ///< [same] by which the log was multiplied before
  bool of_currents = false;  ///< whether the log had them
  /// [1] the factor on this joint's measured torques at which they fit the file's masses best; 0
  /// for currents, whose gain it is, and where these masses take less than kSeen of the torque
  double scale = 0;
  double scale_error = 0;        ///< [1] its robust error
  double rigid = 0;              ///< [N m] rms of what the file's masses take of the torque
  double torque = 0;             ///< [N m] rms of the measured torque
  double before = 0;             ///< [N m] rms that is left without any of these terms
  double after = 0;              ///< [N m] with them
  double unbounded = 0;          ///< [N m] with those of a fit in which nothing is held
  double held_out = 0;           ///< [N m] the same, of stretches that the fit has not seen
  std::vector<Suspect> missing;  ///< what may be missing; the likeliest first
  int windows = 0;               ///< that were used
  int left_out = 0;              ///< that were not
  double fastest = 0;            ///< [rad/s] in them
  double slip = 0;     ///< [rad/s] over which friction would have to be smooth, as tree_of() has it
  double largest = 0;  ///< [N m] of all measured torques
  std::vector<std::string> held;    ///< what was held at its bound, in words
  std::vector<std::string> doubts;  ///< why these numbers are not to be used; else none
};

/// The windows of a joint, a row for each.
struct JointRows {
  Eigen::MatrixXd terms;              ///< what the parameters multiply
  Eigen::MatrixXd term_instruments;   ///< of these (windows.h)
  Eigen::VectorXd rigid;              ///< [N m] what the masses take
  Eigen::VectorXd rigid_instrument;   ///< of that
  Eigen::VectorXd measured;           ///< [N m] or [A]
  Eigen::MatrixXd others;             ///< what may be missing
  std::vector<std::string> suspects;  ///< the names of these
  int left_out = 0;                   ///< windows that are not here
  double fastest = 0;                 ///< [rad/s] in those that are
};

/// @param names of the terms
/// @param currents whether they are what was measured
/// @param scale whether the gain of torques is to be found, where it is seen
/// @throws std::invalid_argument for a gain that cannot be seen, and as fit()
CalibratedJoint calibrated_joint(const JointRows& rows, const std::vector<std::string>& names,
                                 bool currents, bool scale = false);

}  // namespace tauext
