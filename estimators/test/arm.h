// SPDX-License-Identifier: Apache-2.0
// The simulated arm under the names that the tests use.
#pragma once

#include "bench/kit/simulated_arm.h"

namespace tauext::test {
using namespace simulated;
}  // namespace tauext::test
