// SPDX-License-Identifier: Apache-2.0
// Every estimator of the roster, one after the other, for the conformance tests.
#pragma once

#include "bench/roster/roster.h"

namespace tauext::test {

// calls claim(make) for every kind that estimates
template <class Arm, class Claim>
int for_every_estimator(Claim&& claim) {
  int count = 0;
  for_each_estimator(Arm(), [&](const auto& entry) {
    claim([entry] { return entry(); });
    ++count;
  });
  return count;
}

}  // namespace tauext::test
