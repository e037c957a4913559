// SPDX-License-Identifier: Apache-2.0
/// @file
/// The kernels' times and instructions as a table, line by line, so that each line can be shown by
/// itself.
#pragma once

#include <string>
#include <vector>

#include "regression/report/layers.h"

namespace tauext::gate {

struct KernelTable {
  std::string header;
  std::vector<std::string> rows;  ///< one for each of result.time->kernels, in their order
};

/// Of a result with a time layer.
KernelTable kernel_table(const GateResult& result);

/// What a longer run of them showed; "" if there was none.
std::string life_table(const GateResult& result);

/// How the instructions of a kernel changed beside base; nullptr: not at all, or nobody counted.
const CountChange* change_of(const GateResult& result, const std::string& kernel);

/// Why a kernel's time and instructions are as they are, in a few words; "" if there is nothing to
/// say.
std::string why(const GateResult& result, const KernelTime& time);

}  // namespace tauext::gate
