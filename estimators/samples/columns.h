// SPDX-License-Identifier: Apache-2.0
/// @file
/// Samples of an arm of any number of joints, and estimates of them, where they lie: a number of
/// each joint, then those of the next sample, as the columns of a matrix of Eigen.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "estimators/types.h"

namespace tauext {

template <int W>
class Pack;

namespace detail {
template <class Scalar, class Value>
struct OfRuns {
  using type = Value;
};
template <int W, class Value>
struct OfRuns<Pack<W>, Value> {
  using type = std::array<Value, W>;
};
}  // namespace detail

/// A Value, or with a Pack for Scalar one of each run.
template <class Scalar, class Value>
using OfRuns = typename detail::OfRuns<Scalar, Value>::type;

/// What is measured; with a Pack for Scalar, in several runs of one clock. It must outlive this.
template <class Scalar = double>
struct SampleColumns {
  int joints = 0;               ///< of the arm
  std::size_t size = 0;         ///< samples
  const double* t = nullptr;    ///< [s]
  const Scalar* q = nullptr;    ///< [rad]
  const Scalar* qd = nullptr;   ///< [rad/s]
  const Scalar* tau = nullptr;  ///< [N m]

  /// Sample k. N must be `joints`.
  template <int N>
  Measurement<N, Scalar> at(std::size_t k) const noexcept {
    using Values = Eigen::Map<const Vec<N, Scalar>>;
    return {Scalar(t[k]), Values(q + k * N), Values(qd + k * N), Values(tau + k * N)};
  }
  /// So many of them, from one on.
  SampleColumns part(std::size_t from, std::size_t n) const noexcept {
    const std::size_t at = from * static_cast<std::size_t>(joints);
    return {joints, n, t + from, q + at, qd + at, tau + at};
  }
};

/// Where as many estimates are written.
template <class Scalar = double>
struct EstimateColumns {
  Scalar* tau_ext = nullptr;                          ///< [N m]
  OfRuns<Scalar, Status>* status = nullptr;           ///< of each sample
  OfRuns<Scalar, std::uint8_t>* of_joints = nullptr;  ///< Estimate::joints
};

}  // namespace tauext
