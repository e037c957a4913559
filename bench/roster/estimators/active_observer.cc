// SPDX-License-Identifier: Apache-2.0
#include "estimators/active_observer.h"

#include "bench/roster/estimator_type.h"

namespace tauext {
namespace {

[[gnu::used]] constexpr auto kActiveObserver = compiled_types<ActiveObserver>();

}  // namespace
}  // namespace tauext
