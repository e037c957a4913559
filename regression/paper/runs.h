// SPDX-License-Identifier: Apache-2.0
/// @file
/// Runs for the paper's claims: a scenario recorded, an estimator run over it.
#pragma once

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>

#include "bench/roster/robots.h"
#include "bench/roster/roster.h"
#include "mjcf/record.h"

namespace tauext::test {

inline Trace record_of(const std::string& robot, const std::string& name) {
  const Scenario& s = scenario(robot, name);
  return record(load_for(robot, s), s);
}

inline Output run_by_name(const std::string& robot_name, const std::string& estimator,
                          const Trace& trace, const std::string& detector = "") {
  return robot(robot_name).pair(estimator, detector, trace).run(trace);
}

template <class E>
Output run_of(const E& estimator, const Trace& trace) {
  return Pair(std::make_unique<EstimatorStageOf<E>>(estimator), nullptr).run(trace);
}

// largest |error| of joint 1 over the samples that count
template <class Counts>
double worst_error(const Trace& t, const Output& out, Counts&& counts) {
  double worst = 0;
  for (int k = 0; k < t.size(); ++k) {
    if (counts(k)) worst = std::max(worst, std::abs(out.tau_ext(0, k) - t.tau_ext(0, k)));
  }
  return worst;
}

// whether the joint has moved at `speed` [rad/s] or faster for 0.1 s
inline bool moving(const Trace& t, int k, double speed) {
  for (int i = std::max(0, k - 100); i <= k; ++i) {
    if (std::abs(t.qd(0, i)) < speed) return false;
  }
  return true;
}

}  // namespace tauext::test
