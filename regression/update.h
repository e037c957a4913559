// SPDX-License-Identifier: Apache-2.0
/// @file
/// Moves the baselines: whole files or none, with a reason that stays.
#pragma once

#include <string>

#include "bench/program/exit_code.h"

namespace tauext::gate {

/// What to write, and why.
struct UpdateOptions {
  std::string baselines;  ///< folder of accuracy.tsv and instructions-*.tsv, made if it is missing
  std::string changelog;  ///< file that gains a line for each update
  std::string reason;     ///< one line, not empty
  std::string accept_worse;      ///< why what is worse is right; empty: nothing may be worse
  std::string head, bench;       ///< plug-in and program; an empty one: its baseline stays
  std::string kernels, entries;  ///< regular expressions: the lines of others stay; empty: all
};

/// What was done.
struct UpdateResult {
  /// refused, as something is worse and nobody said that it may be: kSlower if a kernel's count is,
  /// else kLessAccurate
  ExitCode code = kGood;
  std::string text;  ///< for people: what changed, or what is worse
};

/// Writes the baselines of head and a line in the changelog. Baselines of other keys stay.
/// @throws std::invalid_argument for a reason that is empty or has more than one line,
/// std::runtime_error for files and programs; nothing is changed then
UpdateResult update_baselines(const UpdateOptions& options);

}  // namespace tauext::gate
