// SPDX-License-Identifier: Apache-2.0
/// @file
/// Measures a commit for a history.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "regression/history/history.h"

namespace tauext::gate {

/// What is measured, beside what.
struct MeasureOptions {
  std::string base, head;        ///< plug-ins of the reference and of the commit
  std::string bench;             ///< the commit's program with --golden; empty: no metrics
  std::string baselines;         ///< the commit's folder, for what it accepts
  std::string kernels, entries;  ///< regular expressions; empty: all
  Record record;  ///< commit, date, title and reference, none of them empty but the title
  std::function<void(const std::string&)> progress;  ///< may be empty
};

/// The record of that commit, with all metrics that are not as at the end of `history`. Kernels of
/// one side alone are left out; what is too noisy for a verdict has no `surely`.
/// @throws std::invalid_argument for a name that is empty or a commit that is on record,
/// std::runtime_error for files and programs
Record measure(const MeasureOptions& options, const std::vector<Record>& history);

}  // namespace tauext::gate
