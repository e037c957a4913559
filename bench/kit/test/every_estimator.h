// SPDX-License-Identifier: Apache-2.0
// Every estimator of the roster, one after the other, for the conformance tests.
#pragma once

#include "bench/roster/robot.h"
#include "bench/roster/roster.h"

namespace tauext::test {

// calls claim(make) for every kind that estimates; baselines only know their trace
template <class Arm, class Claim>
int for_every_estimator(Claim&& claim) {
  int count = 0;
  for_each_estimator(Arm(), [&](auto make) {
    using E = decltype(make(Trace()));
    if (is_baseline(E::kName)) return;
    claim([make] { return make(Trace()); });
    ++count;
  });
  return count;
}

}  // namespace tauext::test
