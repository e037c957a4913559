// SPDX-License-Identifier: Apache-2.0
/// @file
/// A robot file of ours: which MJCF or URDF an arm has, and what was measured of it.
///
///     {
///       "format": "tauext-robot-1",
///       "file": "ur10e.urdf",                 // by this file's folder
///       "lock": "finger.*",                   // joints that are fixed (ImportOptions); optional
///       "joints": {
///         "elbow_joint": {                    // each key is optional; without it, as in the file
///           "armature": 0.42,                 // kg m^2
///           "coulomb": 7.1,                   // N m; [up, down] where qd > 0, where qd < 0
///           "viscous": 9.8,                   // N m s/rad; likewise
///           "offset": 0.3,                    // N m that tau is always too large by
///           "gain": 9.6,                      // N m/A of the drive, for logs of currents
///           "torque_gain": 1.04,              // by which torques of logs are multiplied
///           "effort": 150, "velocity": 3.1,   // N m and rad/s that the drive can do at most
///           "standard_errors": {..}           // of the same keys; for the reader
///         }
///       },
///       "bodies": {
///         "forearm": {                        // each that is here, with all that is fixed to it
///           "mass": 3.9,                      // kg
///           "center": [0, 0, 0.21],           // m, of mass, in the body's frame
///           "inertia": [0.11, 0.11, 0.01, 0, 0, 0]  // kg m^2, xx, yy, zz, xy, xz, yz of the
///         }                                   // tensor about that center, in the body's axes
///       },
///       "payload": {"body": "wrist_3_link", "mass": 2.8, "center": [0, 0, 0.1]},  // kg, m
///       "about": {..}                         // anything
///     }
///
/// Bodies are those that a joint moves (URDF: links), in the place of what the file says, or does
/// not say, of their masses; what a body has on it that no joint moves is part of it, and the
/// payload adds to that. A body's payload stands in its frame; a site may be named instead. No
/// offset can be told from a Coulomb friction that differs by the direction: [up, down] is
/// (up + down) / 2 and an offset of (up - down) / 2.
#pragma once

#include <string>
#include <string_view>

#include "mjcf/import/mjcf_text.h"

namespace tauext {

/// Its "format".
inline constexpr const char* kRobotFileFormat = "tauext-robot-1";

/// Whether a robot's name is the path of such a file: it ends in .json.
bool is_our_robot_file(std::string_view path);

/// Why a path is no robot that can be read, though it looks like one of another kind (xacro, SDF,
/// USD, a folder, an address), and the command that makes a file of it; "" for any other path.
std::string why_other_kind(const std::string& path);

/// What it says.
struct RobotFile {
  std::string path;       ///< of the MJCF or URDF, from where this program runs
  ImportOptions options;  ///< how it is to be read
};

/// What a robot's path stands for: a file of ours, or another one, which is itself.
/// @throws std::runtime_error or std::invalid_argument naming the path, the key and what is wrong;
/// also for two different locks, and as why_other_kind() says
RobotFile robot_file(const std::string& path, const ImportOptions& options = {});

}  // namespace tauext
