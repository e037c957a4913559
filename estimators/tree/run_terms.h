// SPDX-License-Identifier: Apache-2.0
/// @file
/// The terms of an arm's equation of motion at the samples of a run, or of several at once, for all
/// estimators that see them: each is computed once, by the first that asks.
#pragma once

#include <cstddef>
#include <vector>

#include "estimators/concepts.h"
#include "estimators/math/lanes.h"
#include "estimators/samples/columns.h"

namespace tauext {

/// What one arm answers at the samples of a run; with a Pack for Scalar, of several runs. Not for
/// several threads at once.
template <int N, class Scalar = double>
class RunTerms {
 public:
  using VecN = Vec<N, Scalar>;  ///< a number of each joint
  /// Where in the run who asks is; each has one of its own.
  using At = std::size_t;

  /// @param samples of the run, of N joints
  explicit RunTerms(const SampleColumns<Scalar>& samples) : samples_(samples) {}

  /// compute(), or what it gave at this sample before; where (q [rad], qd [rad/s]) is none of the
  /// next samples, always compute(). It stays until the next question.
  template <class Compute>
  const Dynamics<N, Scalar>& dynamics(At& at, const VecN& q, const VecN& qd,
                                      const Compute& compute) noexcept {
    return answer(dynamics_, at, is_at(q, qd), compute);
  }
  /// The same of momentum_dynamics().
  template <class Compute>
  const Dynamics<N, Scalar>& momentum_dynamics(At& at, const VecN& q, const VecN& qd,
                                               const Compute& compute) noexcept {
    return answer(momentum_dynamics_, at, is_at(q, qd), compute);
  }
  /// The same of friction().
  template <class Compute>
  const VecN& friction(At& at, const VecN& qd, const Compute& compute) noexcept {
    const auto here = [&](At k) { return same(qd, samples_.qd, k); };
    return answer(friction_, at, here, compute);
  }

 private:
  template <class Value>
  struct Answers {
    std::vector<bool> known;
    std::vector<Value> at;  // a sample
    Value elsewhere;
  };

  // whether x is column k
  static bool same(const VecN& x, const Scalar* columns, At k) noexcept {
    using tauext::all;
    for (At j = 0; j < N; ++j) {
      if (!all(x[static_cast<Eigen::Index>(j)] == columns[k * N + j])) return false;
    }
    return true;
  }
  auto is_at(const VecN& q, const VecN& qd) const noexcept {
    return [&](At k) { return same(q, samples_.q, k) && same(qd, samples_.qd, k); };
  }

  template <class Value, class Here, class Compute>
  const Value& answer(Answers<Value>& answers, At& at, const Here& here,
                      const Compute& compute) noexcept {
    for (At k = at; k < samples_.size && k < at + kAhead; ++k) {
      if (!here(k)) continue;
      at = k;
      answers.known.resize(samples_.size), answers.at.resize(samples_.size);
      if (!answers.known[k]) answers.known[k] = true, answers.at[k] = compute();
      return answers.at[k];
    }
    return answers.elsewhere = compute();
  }

  static constexpr At kAhead = 64;  // an estimator may have left out so many

  SampleColumns<Scalar> samples_;
  Answers<Dynamics<N, Scalar>> dynamics_, momentum_dynamics_;
  Answers<VecN> friction_;
};

}  // namespace tauext
