// SPDX-License-Identifier: Apache-2.0
/// @file
/// Other programs, without a shell between.
#pragma once

#include <string>
#include <vector>

namespace tauext::gate {

/// Path of the running program.
std::string this_program();

/// The processor's name in /proc/cpuinfo, or "unknown processor".
std::string processor();

/// Runs a program (found in PATH unless it has a slash), its standard error ours.
/// @return its standard output
/// @throws std::runtime_error naming the program, if it is not there, fails or is killed
std::string run_child(const std::vector<std::string>& argv);

/// The same, with the exit code for an answer instead of an error. 127: it could not be started.
struct Finished {
  int code;
  std::string output;
};
Finished finish_child(const std::vector<std::string>& argv);

}  // namespace tauext::gate
