// SPDX-License-Identifier: Apache-2.0
/// @file
/// Masses of bodies that somebody measured, or that nobody knows.
#pragma once

#include <Eigen/Core>
#include <map>
#include <set>
#include <string>

#include "mjcf/import/measured_terms.h"

namespace tauext::detail {

/// [kg m^2] Its tensor about the center of mass, in the body's axes.
Eigen::Matrix3d tensor(const MeasuredBody& body);

/// Puts them into MJCF: the <inertial> of each such body has all of it, and what is fixed to the
/// body has no mass.
/// @throws std::runtime_error for a name that is none of a body with a joint, listing those; and
/// where <compiler> lets shapes, or one sum, say the masses
void put_bodies(tinyxml2::XMLElement& mujoco, const std::map<std::string, MeasuredBody>& bodies);

/// Gives each body that a joint moves, and that has no mass, that of a ball of 1 kg.
/// @returns their names
/// @throws std::runtime_error naming the line of one without a name
std::set<std::string> fill_masses(tinyxml2::XMLElement& mujoco);

}  // namespace tauext::detail
