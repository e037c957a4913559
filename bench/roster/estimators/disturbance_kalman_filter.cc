// SPDX-License-Identifier: Apache-2.0
#include "estimators/disturbance_kalman_filter.h"

#include "bench/roster/estimator_type.h"

namespace tauext {
namespace {

template <RobotModel M>
using ConstantKalmanFilter = DisturbanceKalmanFilter<M>;

[[gnu::used]] constexpr auto kConstantKalmanFilter = compiled_types<ConstantKalmanFilter>();
[[gnu::used]] constexpr auto kAdaptiveKalmanFilter = compiled_types<AdaptiveKalmanFilter>();

}  // namespace
}  // namespace tauext
