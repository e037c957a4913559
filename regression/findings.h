// SPDX-License-Identifier: Apache-2.0
/// @file
/// What there is to say of a result, one thing at a time; regression/report.h puts it into a form.
#pragma once

#include <string>
#include <vector>

#include "regression/layers.h"

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

/// A line for each layer.
std::vector<std::string> summary(const GateResult& result);

/// Over the lines of the time layer.
std::string kernel_header();

/// Why a kernel's time and instructions are as they are, in a few words; "" if there is nothing to say.
/// @param count how its instructions changed; nullptr: not at all, if they were counted
std::string why(const KernelTime& time, const CountChange* count, bool counted);

/// A regular expression that matches this name alone.
std::string exactly(const std::string& name);

}  // namespace tauext::gate
