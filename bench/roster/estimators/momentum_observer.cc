// SPDX-License-Identifier: Apache-2.0
#include "estimators/momentum_observer.h"

#include "bench/roster/estimator_type.h"

namespace tauext {
namespace {

[[gnu::used]] constexpr auto kMomentumObserver = compiled_types<MomentumObserver>();

}  // namespace
}  // namespace tauext
