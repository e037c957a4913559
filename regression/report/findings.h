// SPDX-License-Identifier: Apache-2.0
/// @file
/// What there is to say of a result, one thing at a time.
#pragma once

#include <string>
#include <vector>

#include "bench/program/exit_code.h"
#include "regression/report/layers.h"

namespace tauext::gate {

/// One thing that was looked at.
struct Finding {
  std::string layer, subject;
  Verdict verdict = Verdict::kPass;
  std::string text;               ///< one line
  std::vector<std::string> more;  ///< reasons, and the command that shows it again
  bool harness_error = false;     ///< the gate itself did not work
};

/// All of them, layer by layer.
std::vector<Finding> findings(const GateResult& result);

/// What they say together. A harness that is broken (kCouldNotRun) counts before kSlower, that
/// before kLessAccurate, kUpdateNeeded and kInconclusive.
ExitCode exit_code(const GateResult& result);

/// What it means that there was no base, and why there was none.
std::string no_base_text(const GateResult& result);

/// A line for each layer.
std::vector<std::string> summary(const GateResult& result);

/// A regular expression that matches this name alone.
std::string exactly(const std::string& name);

/// The command that scores an entry again. @param seed "seed 3" or "3"
std::string score_command(const std::string& bench, const std::string& entry,
                          const std::string& seed);

}  // namespace tauext::gate
