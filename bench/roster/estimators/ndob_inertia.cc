// SPDX-License-Identifier: Apache-2.0
#include "estimators/ndob_inertia.h"

#include "bench/roster/estimator_type.h"

namespace tauext {
namespace {

[[gnu::used]] constexpr auto kNdobInertia = compiled_types<NdobInertia>();

}  // namespace
}  // namespace tauext
