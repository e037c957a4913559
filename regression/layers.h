// SPDX-License-Identifier: Apache-2.0
/// @file
/// The layers together: what is asked, what they found, and the exit code that follows.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "regression/accuracy.h"
#include "regression/instructions.h"
#include "regression/time_layer.h"

namespace tauext::gate {

/// Exit codes of tauext-gate.
enum GateCode : int {
  kPassed = 0,
  kSlower = 1,  ///< more time or more instructions
  kLessAccurate = 2,
  kUpdateNeeded = 3,  ///< no baseline, or one that has to be looked at
  kInconclusive = 4,  ///< too noisy to say
  kUsage = 64,
  kHarnessError = 70,  ///< the gate itself, or one of its files, is broken
};

/// Where everything is.
struct GateOptions {
  std::string base, head;        ///< plug-ins; an empty base: there is nothing to compare with
  std::string bench;             ///< program with --golden; empty: no accuracy
  std::string baselines;         ///< folder
  std::string kernels, entries;  ///< regular expressions; empty: all
  bool time = true, instructions = true, accuracy = true;
  bool even_if_identical = false;
  TimeLimits limits;
  double period = 1e-3;  ///< [s]
  std::function<void(const std::string&)> progress;
};

/// Instructions of head: beside base, and beside what was committed.
struct InstructionReport {
  int kernels = 0;
  std::vector<CountChange> beside_base, beside_committed;
  std::string no_baseline;               ///< why nothing is committed for this key; "" if it is
  std::vector<std::string> added, gone;  ///< beside the committed
  std::string other_key;                 ///< why base cannot be compared with head; "" if it can
  std::optional<Counts> base, head;      ///< as counted
};

/// What was found; what was not asked for is empty.
struct GateResult {
  std::optional<TimeReport> time;
  std::optional<InstructionReport> instructions;
  std::optional<AccuracyReport> accuracy;
  std::vector<std::string> not_repeated;  ///< T0
  std::vector<std::string> notes;         ///< what could not be compared, and why
  std::string base, head, bench;          ///< to be named in commands
};

/// Runs the layers that were asked for.
/// @throws std::invalid_argument for filters that match nothing, std::runtime_error for files and programs
GateResult run_layers(const GateOptions& options);

/// kHarnessError before kSlower before kLessAccurate before kUpdateNeeded before kInconclusive.
GateCode exit_code(const GateResult& result);

/// A program's golden metrics of the entries that match.
/// @param seeds "" for the program's own
/// @throws std::runtime_error naming the program, if it fails
Golden run_bench(const std::string& bench, const std::string& entries, const std::string& seeds);

/// Path of the golden metrics in a folder of baselines.
std::string golden_path(const std::string& folder);

/// Whether a count grew beyond the limit.
bool too_many(const CountChange& change);

}  // namespace tauext::gate
