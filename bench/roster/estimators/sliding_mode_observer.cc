// SPDX-License-Identifier: Apache-2.0
#include "estimators/sliding_mode_observer.h"

#include "bench/roster/estimator_type.h"

namespace tauext {
namespace {

[[gnu::used]] constexpr auto kSlidingModeObserver = compiled_types<SlidingModeObserver>();

}  // namespace
}  // namespace tauext
