// SPDX-License-Identifier: Apache-2.0
/// @file
/// The layers together: what is asked, and what they found.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "regression/accuracy/accuracy.h"
#include "regression/counts/count_layer.h"
#include "regression/memory/acceptance.h"
#include "regression/memory/committed.h"
#include "regression/time/time_layer.h"

namespace tauext::gate {

/// Where everything is.
struct GateOptions {
  std::string base, head;        ///< plug-ins; an empty base: there is nothing to compare with
  std::string bench;             ///< program with --golden; empty: no accuracy
  std::string baselines;         ///< folder
  std::string kernels, entries;  ///< regular expressions; empty: all
  std::string changelog;         ///< of the baselines
  Committed base_committed;      ///< what base's commit holds; empty: not looked at
  std::string no_base;           ///< why there is no base, if somebody knows
  bool time = true, instructions = true, accuracy = true;
  bool even_if_identical = false;
  TimeLimits limits;
  double period = 1e-3;  ///< [s]
  std::function<void(const std::string&)> progress;
};

/// What was found; what was not asked for is empty.
struct GateResult {
  std::optional<TimeReport> time;
  std::optional<InstructionReport> instructions;
  std::optional<AccuracyReport> accuracy;
  std::optional<MemoryReport> memory;
  std::string no_base;             ///< why no base was there, though it was to be compared with
  std::vector<std::string> notes;  ///< what else could not be compared, and why
  std::string base, head, bench;   ///< to be named in commands
};

/// Runs the layers that were asked for.
/// @throws std::invalid_argument for filters that match nothing, std::runtime_error for files and
/// programs
GateResult run_layers(const GateOptions& options);

}  // namespace tauext::gate
