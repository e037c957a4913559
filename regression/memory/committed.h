// SPDX-License-Identifier: Apache-2.0
/// @file
/// The numbers that base committed beside those that head did: nothing moves without a reason.
#pragma once

#include <string>
#include <vector>

namespace tauext::gate {

/// What a commit holds.
struct Committed {
  std::string baselines;  ///< folder; empty: there is none
  std::string changelog;  ///< file; one that is not there has no line
};

/// A line that is not as it was.
struct Moved {
  std::string what;    ///< file, entry and metric, or file and kernel
  std::string how;     ///< from what to what
  bool worse = false;  ///< also: gone, or no longer comparable
};

/// What became of the baselines.
struct MemoryReport {
  int lines = 0;                     ///< of head
  std::vector<Moved> moved;          ///< worse ones first
  std::vector<std::string> reasons;  ///< lines that head's changelog has and base's has not
  int accepted = 0;                  ///< so many worse lines they give leave to

  int worse() const;
  bool without_reason() const { return !moved.empty() && reasons.empty(); }
  bool worse_without_leave() const { return worse() > accepted; }
};

/// Compares accuracy.tsv, line by line and to the last bit, and the counts of every key. Worse is
/// what tauext-gate update would not write without --accept-worse.
/// @throws std::runtime_error naming the path: a file of head that is none, an unreadable changelog
MemoryReport compare_committed(const Committed& base, const Committed& head);

}  // namespace tauext::gate
