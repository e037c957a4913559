// SPDX-License-Identifier: Apache-2.0
#include "estimators/inverse_dynamics.h"

#include "bench/roster/estimator_type.h"

namespace tauext {
namespace {

[[gnu::used]] constexpr auto kInverseDynamics = compiled_types<InverseDynamics>();

}  // namespace
}  // namespace tauext
