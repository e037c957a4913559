// SPDX-License-Identifier: Apache-2.0
/// @file
/// What somebody measured of an arm, in the place of what its file says.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>

namespace tinyxml2 {
class XMLElement;
}

namespace tauext {

/// Of a joint; what is not set stays as the file has it. A slide has N for N m, and m for rad.
struct MeasuredJoint {
  std::optional<double> armature;      ///< [kg m^2] of the rotor, as the joint feels it
  std::optional<double> coulomb;       ///< [N m] dry friction
  std::optional<double> viscous;       ///< [N m s/rad] friction by speed
  std::optional<double> viscous_skew;  ///< [N m s/rad] more of it where qd > 0, less where qd < 0
  std::optional<double> offset;        ///< [N m] that tau is always too large by
  std::optional<double> gain;          ///< [N m/A] of the drive
  std::optional<double> torque_gain;   ///< [1] of the torques of logs
  std::optional<double> effort;        ///< [N m] what the drive can do at most
  std::optional<double> velocity;      ///< [rad/s] likewise
};

/// A weight that was mounted.
struct Payload {
  std::string body;              ///< that carries it, or a site of it
  double mass = 0;               ///< [kg]
  double center[3] = {0, 0, 0};  ///< [m] of mass, in the frame of the body or of the site
};

/// What a body that a joint moves has, with all that is fixed to it.
struct MeasuredBody {
  double mass = 0;                         ///< [kg]
  double center[3] = {0, 0, 0};            ///< [m] of mass, in the body's frame
  double inertia[6] = {0, 0, 0, 0, 0, 0};  ///< [kg m^2] xx, yy, zz, xy, xz and yz of the tensor
                                           ///< about the center of mass, in the body's axes
};

/// All of it.
struct MeasuredTerms {
  std::map<std::string, MeasuredJoint> joints;  ///< by name
  std::optional<Payload> payload;               ///< if there is one
  std::map<std::string, MeasuredBody> bodies;   ///< by name

  /// Whether nothing was measured.
  bool empty() const { return joints.empty() && !payload && bodies.empty(); }
};

namespace detail {

/// Before the name of a joint: the <numeric> of what MJCF has no attribute for.
inline constexpr std::string_view kMeasured = "tauext:";

/// Puts them into MJCF, whose joints have names; what has no attribute there stands in <custom>,
/// as mjcf/mujoco/measured.h reads it.
/// @throws std::runtime_error for a joint or a body that it does not have, listing those there are
void put_measured(tinyxml2::XMLElement& mujoco, const MeasuredTerms& terms);

/// Before the name of a joint: the <numeric> with its rated torque [N m] or [N], and speed [rad/s]
/// or [m/s].
inline constexpr std::string_view kRated = "tauext:rated:";

/// Puts what a joint's drive can do into MJCF. A number that is not positive and finite counts as
/// unknown: files have 0 there.
void put_rated(tinyxml2::XMLElement& mujoco, const std::string& joint, double torque, double speed);

}  // namespace detail
}  // namespace tauext
