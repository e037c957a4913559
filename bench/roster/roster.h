// SPDX-License-Identifier: Apache-2.0
/// @file
/// THE list: what the suite runs. One line here adds an estimator or a robot to the benchmark, to
/// tauext-replay and to the conformance tests. (Detectors: detector_list.h; scenarios:
/// mjcf/scenarios/wallmobot3.cc and its like.)
#pragma once

#include <array>
#include <string_view>
#include <type_traits>

#include "bench/roster/estimators.h"
#include "bench/roster/printed_forms.h"
#include "estimators/active_observer.h"
#include "estimators/disturbance_kalman_filter.h"
#include "estimators/extended_state_observer.h"
#include "estimators/higher_order_momentum_observer.h"
#include "estimators/inverse_dynamics.h"
#include "estimators/momentum_observer.h"
#include "estimators/ndob_inertia.h"
#include "estimators/sliding_mode_observer.h"
#include "estimators/testbed1.h"
#include "estimators/wallmobot3.h"

namespace tauext {

/// The NDOB's gain on the testbed, for which the paper prints none: X = 100 1/s theta_1, a pole of
/// 100 rad/s. Its 10 ms are a tenth of a human's quickest push, and 1e-3 rad/s of velocity noise
/// cost 0.04 N m.
inline Ndob<Testbed1>::Parameters testbed1_ndob() {
  return {.X = Vec<1>(100 * Testbed1::Parameters().theta1)};
}

/// Builds E with these parameters.
template <class E, RobotModel M>
RosterEntry<E, M> with(const M& model, const typename E::Parameters& parameters) {
  return {model, parameters};
}

/// Calls visit(entry) for the estimators that every arm has.
template <RobotModel M, class Visit>
void for_each_common_estimator(const M& model, Visit&& visit) {
  const auto at_bandwidth = [&]<class E>(std::type_identity<E>) {
    visit(with<E>(model, E::Parameters::for_bandwidth(model, kRosterBandwidth)));
  };
  at_bandwidth(std::type_identity<InverseDynamics<M>>());
  at_bandwidth(std::type_identity<MomentumObserver<M>>());
  at_bandwidth(std::type_identity<MomentumObserver2<M>>());
  at_bandwidth(std::type_identity<MomentumObserver3<M>>());
  at_bandwidth(std::type_identity<NdobInertia<M>>());
  at_bandwidth(std::type_identity<DisturbanceKalmanFilter<M>>());
  at_bandwidth(std::type_identity<AdaptiveKalmanFilter<M>>());
  at_bandwidth(std::type_identity<SlidingModeObserver<M>>());
  at_bandwidth(std::type_identity<ActiveObserver<M>>());
  at_bandwidth(std::type_identity<ExtendedStateObserver<M>>());
}

/// Calls visit(entry) for every estimator of a robot that is not named below. The NDOB is there as
/// ndob_wb: no diagonal X fits an arm of many joints, whose B couples them by its pose.
template <RobotModel M, class Visit>
void for_each_estimator(const M& model, Visit&& visit) {
  for_each_common_estimator(model, visit);
  if constexpr (DifferentiableModel<M>) {
    visit(with<Ekf<M>>(model, Ekf<M>::Parameters::for_bandwidth(model, kRosterBandwidth)));
  }
}

/// Calls visit(entry) for every estimator of wallmobot3.
template <class Visit>
void for_each_estimator(const WallMoBot3& arm, Visit&& visit) {
  using M = WallMoBot3;
  for_each_common_estimator(arm, visit);
  visit(with<Ekf<M>>(arm, Ekf<M>::Parameters::paper()));
  visit(with<EkfHonest>(arm, EkfHonest::Parameters::honest()));
  visit(with<Ndob<M>>(arm, Ndob<M>::Parameters::paper()));
}

/// Calls visit(entry) for every estimator of testbed1.
template <class Visit>
void for_each_estimator(const Testbed1& arm, Visit&& visit) {
  using M = Testbed1;
  for_each_common_estimator(arm, visit);
  const Testbed1 raw_sign(Testbed1::Parameters::raw_sign());
  visit(with<Ekf<M>>(arm, Ekf<M>::Parameters::paper()));
  visit(with<EkfZeroStart>(arm, EkfZeroStart::parameters()));
  visit(with<EkfRawSign>(raw_sign, EkfRawSign::Parameters::paper()));
  visit(with<Ndob<M>>(arm, testbed1_ndob()));
  visit(with<NdobRawSign>(raw_sign, testbed1_ndob()));
}

/// Calls visit(name, model) for every robot; the MJCF of that name is its truth.
template <class Visit>
void for_each_robot(Visit&& visit) {
  visit("wallmobot3", WallMoBot3());
  visit("testbed1", Testbed1());
}

/// Robots of ours whose estimators know them by their MJCF, as those from files: with the
/// estimators that every arm has, and generic scenarios. The suite runs them where it is asked to.
inline constexpr std::array<std::string_view, 1> kRobotsByMjcf = {"wallmobot6"};

}  // namespace tauext
