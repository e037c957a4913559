// SPDX-License-Identifier: Apache-2.0
#include "estimators/higher_order_momentum_observer.h"

#include "bench/roster/estimator_type.h"

namespace tauext {
namespace {

[[gnu::used]] constexpr auto kMomentumObserver2 = compiled_types<MomentumObserver2>();
[[gnu::used]] constexpr auto kMomentumObserver3 = compiled_types<MomentumObserver3>();

}  // namespace
}  // namespace tauext
