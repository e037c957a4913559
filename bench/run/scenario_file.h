// SPDX-License-Identifier: Apache-2.0
/// @file
/// Scenarios of your own, from a JSON file.
#pragma once

#include <string>
#include <vector>

#include "bench/roster/robot.h"

namespace tauext {

/// Reads scenarios for that robot, all in SI units, joints counted from 1:
///
///     { "scenarios": [ {
///         "name": "pick", "description": "..", "duration": 10, "score_from": 1,
///         "asks": "error",            or step, lag, detection, bandwidth
///         "way_points": [ { "t": 0, "q": [0, 0.3] }, { "t": 2, "q": [0.5, 0.3] } ],
///         "sines": [ { "joint": 2, "amplitude": 0.1, "w": 2, "phase": 0 } ],
///         "loads": [ { "joint": 1, "torque": 5, "from": 3, "to": 6 },
///                    { "joint": 2, "torque": 2, "w": 1, "phase": 0 },
///                    { "joint": 3, "torque": 9, "from": 2, "to": 38, "sweep": true } ],
///         "touches": [ { "kind": "blow", "t": 7, "rise": 0.02, "force": [0, 0, 80] },
///                      { "kind": "push", "t": 8, "rise": 1, "hold": 1, "fall": 1, "force": [20, 0, 0] } ],
///         "regions": [ { "region": "hand", "t": 3, "direction": [0, 0, 1], "speed": 0.25,
///                        "at": ["link4", "link5", 0.5] },
///                      { "region": "chest", "meeting": "grazing", "t": 5, "direction": [0, 0, 1],
///                        "depth": 0.005, "rise": 0.03 },
///                      { "region": "face", "meeting": "clamped", "t": 7, "direction": [0, 0, 1],
///                        "force": 65, "rise": 0.2, "hold": 0.5, "fall": 0.2 } ],
///         "degrade": { "velocity_noise": 1e-3, "model_error": { "mass": 1.05 } },
///         "reaches_limits": false } ] }
///
/// All but name and duration may be left out. The arm starts at rest or on its sines at the first
/// way point, moves from one to the next with minimum jerk, and stays at the last; without any, it
/// stays at its home (Robot::home). Loads have the sign of (3); a sweep is a sine from 0.5 to 300
/// rad/s. A bandwidth is asked of sweeps alone, a step of constant loads alone, and a lag of
/// scenarios that last 2.1 s or more beyond score_from. A joint whose truth stands still is not
/// asked for its answer. Touches are forces on the arm at its end effector, in the world frame;
/// blow and clamp count as collisions, push does not. Regions are masses on springs that meet the
/// arm at a point (mjcf/scenarios/regions.h), and collisions all; "share_of_limit" may stand for
/// "speed", and "stiffness_factor" be given. What is degraded is what --degrade takes, and is used
/// unless the program was asked for other faults.
/// @throws std::runtime_error naming file, scenario, key and value, and what is known or possible
std::vector<Scenario> read_scenarios(const std::string& path, const Robot& robot);

/// Adds them to the robot's list, before that is first asked for.
/// @throws std::runtime_error also for a name that is taken
void add_scenarios(const std::string& path, const Robot& robot);

}  // namespace tauext
