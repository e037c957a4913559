// SPDX-License-Identifier: Apache-2.0
/// @file
/// Instructions of a kernel by source line, and what became of them from one commit to another.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace tauext::gate {

/// Instructions by file and line, as the compiler says where they come from.
using LineCounts = std::map<std::pair<std::string, int>, std::uint64_t>;

/// Lines that execute more or less than they did.
struct LineChange {
  std::string file;
  int line = 0;         ///< the first of head's, or the one behind those that are gone
  std::int64_t by = 0;  ///< instructions more, all steps together
};

/// What differs, the most first. Lines have moved where a commit put others before them, so those
/// of equal counts are paired in their order, as many as can be, and what is left between two pairs
/// is one change.
std::vector<LineChange> changed_lines(const LineCounts& before, const LineCounts& after);

}  // namespace tauext::gate
