// SPDX-License-Identifier: Apache-2.0
/// @file
/// What keeps a model from being an arm.
#pragma once

#include <string>
#include <vector>

#include "mjcf/mujoco/handles.h"

namespace tauext {

/// One thing that an ArmTree (mjcf/plant/tree.h) would have to ignore.
struct Misfit {
  std::string words;        ///< with its remedy
  std::vector<int> joints;  ///< that take it away where all of them are locked; none if they do not
};

/// All of them: free and ball joints, springs (but of joints that an equality holds), forces of
/// tendons, equalities that ties_of() refuses, a fluid; and no joint at all.
std::vector<Misfit> misfits_of(const mjModel& m);

/// Their words in one line.
std::string in_words(const std::vector<Misfit>& misfits);

}  // namespace tauext
