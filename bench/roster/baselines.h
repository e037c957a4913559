// SPDX-License-Identifier: Apache-2.0
/// @file
/// Estimators that check the metrics and not the arm: the worst guess, the perfect one, and the
/// perfect one too late. They may see the truth, which is why they do not live in estimators/.
#pragma once

#include <string_view>
#include <vector>

#include "bench/roster/estimators.h"

namespace tauext {

/// `zero`, always 0: what not estimating costs; `truth`, which scores exactly 0; `delayed_truth`,
/// 10 samples late (0 before). Those of the truth count samples: they are right only on their own
/// trace.
std::vector<EstimatorType> baseline_types(int joints);

/// Whether an estimator's specification is that of one that copies the recorded truth.
bool needs_truth(std::string_view estimator);

/// Whether it is one of these, which stand outside the competition.
bool is_baseline(std::string_view estimator);

}  // namespace tauext
