// SPDX-License-Identifier: Apache-2.0
/// @file
/// Our estimators beside what an engineer writes with KDL: time and error on one trace, in one
/// process.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "bench/roster/robot.h"

namespace tauext::peers {

/// One estimator.
struct Peer {
  std::string name;    ///< of observers.h, or the roster
  std::string beside;  ///< ours of the same kind; its own name for ours
  double ns = 0;       ///< [ns] of CPU time a step: the median of rounds
  double spread = 0;   ///< [1] half of what lies between the quartiles of rounds, as a share
  double ratio = 1;    ///< [1] of its time to that of `beside`: the median of rounds
  double rmse = 0;     ///< [N m] of the worst joint, over what the scenario scores
};

/// All of them on an arm with 3, 6 or 7 joints in a chain, at so many rad/s, over its scenario.
/// @param module path of tauext_kdl.so (kdl_module.h)
/// @param progress called with the share that is done; may be empty
/// @throws std::invalid_argument for another arm, an unknown scenario; std::runtime_error
/// naming the module if it cannot be loaded
std::vector<Peer> compare(const std::string& module, const Robot& robot,
                          const std::string& scenario, double bandwidth, int rounds,
                          const std::function<void(double)>& progress = {});

/// Where tauext_kdl.so is: beside this program, or where it is installed.
std::string module_path();

/// A function of the module.
/// @throws std::runtime_error naming the module
void* function_of(const std::string& module, const char* name);

}  // namespace tauext::peers
