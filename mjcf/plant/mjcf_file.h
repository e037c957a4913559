// SPDX-License-Identifier: Apache-2.0
/// @file
/// MJCF files of users. MuJoCo crashes or hangs at some of them, and believes any number.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "mjcf/import/mjcf_text.h"
#include "mjcf/mujoco/handles.h"
#include "mjcf/trace/child/confined.h"

namespace tauext {

/// From now on MuJoCo's errors are exceptions (std::runtime_error), and it says nothing itself.
void throw_mujoco_errors();

/// The model of the first of these files in memory (MJCF, or MJB if its name ends so), each with
/// its name.
/// @throws std::runtime_error with MuJoCo's words
Model load_files(const std::vector<std::pair<std::string, std::string_view>>& files);

/// Compiles a file in a child process, which also refuses numbers that no machine has (those of
/// dynamics: bodies, joints, tendons, motors, sites, gravity) and tries one step. What MuJoCo
/// 2.2.2 does not read, what is driven by other actuators than motors, and what is to be locked,
/// is imported (mjcf/import/) first.
/// @param changes becomes what the import changed and left out, in one line; "" if nothing
/// @returns MuJoCo's binary form of it (MJB)
/// @throws std::runtime_error in one line, naming the path, the element and what is wrong
std::string compiled_mjcf(const std::string& path, const Limits& limits = {},
                          const ImportOptions& options = {}, std::string* changes = nullptr);

/// Why a file that was compiled with these options is no arm for estimators, with the flags that
/// mend that (mjcf/plant/remedy/remedy.h).
/// @param why without the path, as tree_of() says it
std::string why_no_arm(const std::string& why, const std::string& path, const Limits& limits = {},
                       const ImportOptions& options = {});

}  // namespace tauext
