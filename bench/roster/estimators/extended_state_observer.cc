// SPDX-License-Identifier: Apache-2.0
#include "estimators/extended_state_observer.h"

#include "bench/roster/estimator_type.h"

namespace tauext {
namespace {

[[gnu::used]] constexpr auto kExtendedStateObserver = compiled_types<ExtendedStateObserver>();

}  // namespace
}  // namespace tauext
