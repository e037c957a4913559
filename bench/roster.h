// SPDX-License-Identifier: Apache-2.0
/// @file
/// THE list: what the suite runs. One line here adds an estimator, a detector or a robot to the
/// benchmark, to tauext-replay and to the conformance tests. (Scenarios: mjcf/scenario.cc.)
#pragma once

#include "bench/baselines.h"
#include "estimators/detectors/pan_tompkins.h"
#include "estimators/ekf.h"
#include "estimators/inverse_dynamics.h"
#include "estimators/ndob.h"
#include "estimators/wallmobot3.h"

namespace tauext {

/// Calls visit(make) for every estimator of the arm; make(trace) builds one.
template <RobotModel M, class Visit>
void for_each_estimator(const M& model, Visit&& visit) {
  constexpr int N = M::kDof;
  visit([](const Trace&) { return Zero<N>(); });
  visit([](const Trace& trace) { return Truth<N>(trace); });
  visit([](const Trace& trace) { return DelayedTruth<N>(trace); });
  visit([=](const Trace&) { return InverseDynamics<M>(model); });
  visit([=](const Trace&) { return Ekf<M>(model, Ekf<M>::Parameters::paper()); });
  visit([=](const Trace&) { return Ndob<M>(model, Ndob<M>::Parameters::paper()); });
}

/// Calls visit(make) for every detector of N joints; make() builds one.
template <int N, class Visit>
void for_each_detector(Visit&& visit) {
  visit([] { return PanTompkins<N>(); });
}

/// Calls visit(name, model) for every robot; the MJCF of that name is its truth.
template <class Visit>
void for_each_robot(Visit&& visit) {
  visit("wallmobot3", WallMoBot3());
}

}  // namespace tauext
