// SPDX-License-Identifier: Apache-2.0
/// @file
/// The flags that mend a robot's file.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "mjcf/import/mjcf_text.h"
#include "mjcf/mujoco/handles.h"

namespace tauext {

/// What estimators take: as many joints that follow no other (kMostCoordinates of tree.h), and as
/// many that follow them (kMostFollowers there).
inline constexpr int kMostLeaders = 8, kMostTied = 8;

/// Reads a file anew, with other options.
/// @throws std::runtime_error in one line, and Mendable where flags mend that
using Reading = std::function<Model(const ImportOptions&)>;

/// Why a file is refused, with all else that is wrong with it behind that, and the flags that mend
/// all of it, as a command. They are tried before they are named; where they leave more joints than
/// estimators take, behind them those that leave fewer. Without flags where none help.
/// @param why what was said when it was read with these options
/// @param path as the user wrote it
std::string with_remedy(const std::string& why, const std::string& path,
                        const ImportOptions& options, const Reading& read);

/// The longest row of joints of an arm in which each carries the next and no other one, up to
/// kMostLeaders of those that follow no other.
struct FewerJoints {
  std::vector<std::string> row;     ///< their names
  std::vector<std::string> kept;    ///< and those of joints that follow them
  std::vector<std::string> others;  ///< of all other joints
};
/// @param m has hinges and slides, and no misfits
FewerJoints fewer_joints(const mjModel& m);

}  // namespace tauext
