// SPDX-License-Identifier: Apache-2.0
/// @file
/// The terms of an arm's equation of motion at the samples of a run, for all estimators that see
/// them: each is computed once, by the first that asks.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "estimators/concepts.h"

namespace tauext {

/// What one arm answers at the samples of one run. Not for several threads at once.
template <int N>
class RunTerms {
 public:
  /// Where in the run who asks is; each has one of its own.
  using At = std::size_t;

  /// @param samples of the run, which must outlive it
  explicit RunTerms(std::span<const Measurement<N>> samples)
      : samples_(samples),
        dynamics_(samples.size()),
        momentum_dynamics_(samples.size()),
        friction_(samples.size()) {}

  /// compute(), or what it gave at this sample before; where (q [rad], qd [rad/s]) is none of the
  /// next few samples, always compute().
  template <class Compute>
  Dynamics<N> dynamics(At& at, const Vec<N>& q, const Vec<N>& qd, const Compute& compute) noexcept {
    return answer(dynamics_, at, is_at(q, qd), compute);
  }
  /// The same of momentum_dynamics().
  template <class Compute>
  Dynamics<N> momentum_dynamics(At& at, const Vec<N>& q, const Vec<N>& qd,
                                const Compute& compute) noexcept {
    return answer(momentum_dynamics_, at, is_at(q, qd), compute);
  }
  /// The same of friction().
  template <class Compute>
  Vec<N> friction(At& at, const Vec<N>& qd, const Compute& compute) noexcept {
    return answer(
        friction_, at, [&](const Measurement<N>& y) { return y.qd == qd; }, compute);
  }

 private:
  template <class Value>
  struct Answer {
    bool known = false;
    Value value;
  };

  static auto is_at(const Vec<N>& q, const Vec<N>& qd) noexcept {
    return [&](const Measurement<N>& y) { return y.q == q && y.qd == qd; };
  }

  template <class Value, class Here, class Compute>
  Value answer(std::vector<Answer<Value>>& answers, At& at, const Here& here,
               const Compute& compute) noexcept {
    for (At k = at; k < samples_.size() && k < at + kAhead; ++k) {
      if (!here(samples_[k])) continue;
      at = k;
      if (!answers[k].known) answers[k] = {true, compute()};
      return answers[k].value;
    }
    return compute();
  }

  static constexpr At kAhead = 3;  // an estimator leaves out an outlier

  std::span<const Measurement<N>> samples_;
  std::vector<Answer<Dynamics<N>>> dynamics_, momentum_dynamics_;
  std::vector<Answer<Vec<N>>> friction_;
};

}  // namespace tauext
