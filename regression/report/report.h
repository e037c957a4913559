// SPDX-License-Identifier: Apache-2.0
/// @file
/// What the layers found, for a terminal, for CI services, and for Google Benchmark's compare.py.
#pragma once

#include <string>

#include "regression/report/layers.h"

namespace tauext::gate {

/// For a terminal: what is not well, with its reason and the command that shows it; else a few
/// lines.
/// @param all every kernel, well or not
std::string format_terminal(const GateResult& result, bool all);

/// JUnit XML: a suite a layer, a case a kernel or changed metric.
std::string format_junit(const GateResult& result);

/// The same for the summary page of a CI job.
std::string format_markdown(const GateResult& result);

/// Whether any kernel was timed beside base's.
bool timed(const GateResult& result);

/// Google Benchmark's JSON of one side, a repetition a process; compare.py reads a pair of them.
/// @throws std::invalid_argument if nothing was timed
std::string format_benchmark(const GateResult& result, bool head);

}  // namespace tauext::gate
