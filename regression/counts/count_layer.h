// SPDX-License-Identifier: Apache-2.0
/// @file
/// L1 and L1b: the instructions of a step, beside base's and beside what was committed.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "regression/counts/counts.h"

namespace tauext::gate {

/// What is counted, and what it is compared with.
struct CountOptions {
  std::string base, head;                            ///< plug-ins; an empty base: none
  std::string kernels;                               ///< regular expression; empty: all
  std::string baselines;                             ///< folder
  std::function<void(const std::string&)> progress;  ///< may be empty
};

/// Instructions of head: beside base, and beside what was committed.
struct InstructionReport {
  int kernels = 0;
  std::vector<CountChange> beside_base, beside_committed;
  std::string no_baseline;  ///< why committed counts are needed and not there; "" if none are
  std::string only_base;    ///< why head is compared with base alone; "" if it is not
  std::vector<std::string> added, gone;  ///< beside the committed
  std::string other_key;                 ///< why base cannot be compared with head; "" if it can
  std::optional<Counts> base, head;      ///< as counted

  /// Whether base's instructions of that kernel were counted, too, and can be compared.
  bool compared(const std::string& kernel) const;
};

/// @throws std::invalid_argument for a filter that matches nothing; std::runtime_error as
/// count_instructions and committed_counts do
InstructionReport compare_instructions(const CountOptions& options);

}  // namespace tauext::gate
