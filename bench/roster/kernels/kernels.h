// SPDX-License-Identifier: Apache-2.0
/// @file
/// Estimators and detectors, which are compiled once for each level of instructions that a program
/// is to choose from (CMake's TAUEXT_LEVELS), and once for the processor that all else is for.
#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "bench/roster/robot.h"
#include "estimators/testbed1.h"
#include "estimators/wallmobot3.h"

namespace tauext::detail {

// one number of joints of file_robot(); each is compiled for itself, from file_robot_of.cc.in
template <int N>
std::unique_ptr<const Robot> file_robot_of(const std::string& name, const Model& model);

// one of our robots, by its model; from named_robot_of.cc.in
std::unique_ptr<const Robot> named_robot_of(const std::string& name, const WallMoBot3& model,
                                            const Model& file);
std::unique_ptr<const Robot> named_robot_of(const std::string& name, const Testbed1& model,
                                            const Model& file);

// what was compiled for one level
struct Kernels {
  using OfFile = std::unique_ptr<const Robot> (*)(const std::string& name, const Model& model);
  template <class M>
  using Of = std::unique_ptr<const Robot> (*)(const std::string& name, const M& model,
                                              const Model& file);

  const char* level;  // as -march has it; "" is any processor
  // by joints, less one; null in a program without robots from files
  std::array<OfFile, kMaxFileJoints> of_file;
  Of<WallMoBot3> wallmobot3;
  Of<Testbed1> testbed1;
};

// those of this build, the least first; from tables.cc.in
std::vector<const Kernels*> all_kernels();

// the one of `all`, from the least level to the highest, that is asked for, or, if asked is "", the
// highest one that runs(level)
// @throws std::invalid_argument for one that is not there, or does not run
const Kernels& choose(const std::vector<const Kernels*>& all, bool (*runs)(const std::string&),
                      const std::string& asked);

// that of this processor, or of the environment variable TAUEXT_LEVEL
// @throws std::invalid_argument as choose() does
const Kernels& kernels();

}  // namespace tauext::detail
