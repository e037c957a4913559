// SPDX-License-Identifier: Apache-2.0
/// @file
/// What every estimator and every detector has to do, whoever wrote it, as GoogleTest checks:
///
///     TEST(Mine, Conforms) {
///       tauext::conformance::check_estimator(tauext::WallMoBot3(), [] { return Mine(); });
///     }
/// Link tauext::conformance, which needs Eigen and GoogleTest and neither MuJoCo nor the rest of
/// tauext. make() builds a fresh one for each claim. An estimator with `static constexpr bool
/// kPrintedForm = true` stands for what somebody printed, and is held to being finite and honest
/// about bad samples only.
#pragma once

#include "bench/kit/conformance_detector.h"
#include "bench/kit/conformance_estimator.h"
