// SPDX-License-Identifier: Apache-2.0
/// @file
/// What happens to an arm: how it is told to move, and what the outside does to it.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace tauext {

/// A reference motion, the same for every joint.
struct Reference {
  double q = 0;    ///< [rad]
  double qd = 0;   ///< [rad/s]
  double qdd = 0;  ///< [rad/s^2]
};

/// How the estimates of a scenario are judged beyond their error.
enum class Response {
  kNone,       ///< nothing but the error
  kStep,       ///< rise, settling and overshoot, from the largest jump of the truth
  kLag,        ///< the delay of the estimate behind a truth that moves all the time
  kDetection,  ///< marks against the recorded contact
};

/// A run of any robot. Functions are of time [s]; what they return is held over one sample.
struct Scenario {
  std::string name;
  std::string description;  ///< one line, with numbers and units
  double duration = 30;     ///< [s]
  double score_from = 0;    ///< [s] errors before this are not counted
  Response response = Response::kNone;
  bool start_on_reference = false;  ///< else the arm starts at rest at q = 0
  std::function<Reference(double)> reference;
  std::function<double(double)> tau_ext;  ///< [N m] on every joint, sign of (3)
  std::function<double(double)> force_x;  ///< [N] on the end effector, along world x
  std::function<bool(double)> contact;    ///< whether a collision acts
};

/// All scenarios, in the order in which they are listed.
const std::vector<Scenario>& scenarios();

/// The scenario of that name.
/// @throws std::invalid_argument for an unknown name, listing the known ones
const Scenario& scenario(std::string_view name);

}  // namespace tauext
