// SPDX-License-Identifier: Apache-2.0
/// @file
/// Counts the instructions of a step by valgrind's callgrind, which repeat exactly where times do
/// not.
#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "regression/counts/counts.h"

namespace tauext::gate {

/// Runs every kernel that matches `filter` under callgrind, in a child: "count-worker" of this
/// program, so for tauext-gate alone.
/// No kernel need match.
/// @throws std::runtime_error if valgrind is missing or fails, std::regex_error for a filter that
/// is none
Counts count_instructions(const std::string& plugin, const std::string& filter);

/// The child that runs under callgrind. @return exit code
int count_main(const std::string& plugin, const std::string& filter);

/// What one of callgrind's files says.
struct CallgrindDump {
  std::string trigger;  ///< the kernel's name, "" if it is not one of ours
  std::uint64_t total = 0;
  std::map<std::string, std::uint64_t> functions;  ///< own instructions
  LineCounts lines;  ///< own instructions of what has lines, by path from the tree's top
};

/// @param path to be named in errors
/// @throws std::runtime_error naming the path: cut off, or no file of callgrind's
CallgrindDump parse_callgrind(const std::string& text, const std::string& path);

}  // namespace tauext::gate
