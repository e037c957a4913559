// SPDX-License-Identifier: Apache-2.0
// Every estimator, detector and model of the roster, for tauext-gate.
#include <concepts>

#include "bench/kit/kernels.h"
#include "bench/roster/roster.h"

TAUEXT_PLUGIN(kernels) {
  using namespace tauext;
  for_each_robot([&]<class M>(const std::string& robot, const M& arm) {
    constexpr int N = M::kDof;
    kernels.add_model(robot, arm);
    for_each_estimator(arm, [&](auto make) {
      using E = decltype(make(Trace()));
      // the baselines stand outside the competition, and some of them need a truth
      if constexpr (!std::derived_from<E, DelayedTruth<N>> && !std::same_as<E, Zero<N>>) {
        kernels.add_estimator(robot, arm, make(Trace()));
      }
    });
    for_each_detector<N>([&](auto make) { kernels.add_detector(robot, arm, make()); });
  });
}
