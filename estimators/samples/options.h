// SPDX-License-Identifier: Apache-2.0
/// @file
/// Parameters that several estimators have, each listed once.
#pragma once

#include <array>
#include <cstdint>

#include "estimators/parameters.h"
#include "estimators/types.h"

namespace tauext {

/// The longest step [s] of an estimator, as its Parameters list it.
template <class P>
constexpr auto max_gap_field() {
  return Field{"max_gap", &P::max_gap, "s", 1e-4, 1e3, "a longer gap restarts the estimator"};
}

/// The one bandwidth [rad/s] of an estimator, as its Parameters list it.
template <class P>
constexpr auto bandwidth_field() {
  return Field{"bandwidth",     &P::bandwidth,  "rad/s",
               kLeastBandwidth, kMostBandwidth, "larger is faster and noisier"};
}

/// When the torque of a sample acted.
enum class TorqueSampling : std::uint8_t {
  kHeld,     ///< over [t_k, t_k+1), as a controller's command or a simulation's
  kInstant,  ///< at t_k, as a sensor that is read then: over a step it is the mean of both ends
};

constexpr auto choices(TorqueSampling) {
  return std::array{Choice<TorqueSampling>{"held", TorqueSampling::kHeld},
                    Choice<TorqueSampling>{"instant", TorqueSampling::kInstant}};
}

/// How the torque is sampled, as Parameters list it.
template <class P>
constexpr auto torque_field() {
  return Field{"torque", &P::torque, "", 0, 0, "the wrong one errs in motion"};
}

/// How a nonlinear model is stepped from k-1 to k.
enum class Integration : std::uint8_t {
  kSecondOrder,  ///< an error of h^2: the mean of both ends, or the Taylor terms of h^2
  kEuler,  ///< from the values at k-1 alone, as the paper prints: in motion an error of h/2 B qddd
};

constexpr auto choices(Integration) {
  return std::array{Choice<Integration>{"second_order", Integration::kSecondOrder},
                    Choice<Integration>{"euler", Integration::kEuler}};
}

/// What an observer assumes before its first sample.
enum class Start : std::uint8_t {
  kFirstMeasurement,  ///< the arm moves as first measured and nothing touches it
  kZero,              ///< the state is zero, as the paper prints (its arm starts at rest at q = 0)
};

constexpr auto choices(Start) {
  return std::array{Choice<Start>{"first_measurement", Start::kFirstMeasurement},
                    Choice<Start>{"zero", Start::kZero}};
}

/// How the model is stepped, as Parameters list it.
template <class P>
constexpr auto integration_field() {
  return Field{"integration", &P::integration, "", 0, 0, "euler, as printed, errs in motion"};
}

/// What is assumed at first, as Parameters list it.
template <class P>
constexpr auto start_field() {
  return Field{"start", &P::start, "", 0, 0, "zero, as printed, errs for an arm in motion"};
}

}  // namespace tauext
