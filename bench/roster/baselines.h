// SPDX-License-Identifier: Apache-2.0
/// @file
/// Estimators that check the metrics and not the arm: the worst guess, the perfect one, and the
/// perfect one too late. They may see the truth, which is why they do not live in estimators/.
#pragma once

#include <algorithm>
#include <memory>
#include <string_view>

#include "bench/roster/specification.h"
#include "estimators/concepts.h"
#include "mjcf/trace/trace.h"

namespace tauext {

/// Always 0: what not estimating costs.
template <int N>
class Zero {
 public:
  static constexpr const char* kName = "zero";
  static constexpr int kDof = N;
  void reset() noexcept {}
  Estimate<N> update(const Measurement<N>&) noexcept { return {}; }
};

/// The truth, `Delay` samples late (0 before). Counts samples: it is right only on its own trace.
template <int N>
class DelayedTruth {
 public:
  static constexpr const char* kName = "delayed_truth";
  static constexpr int kDof = N;

  /// The truth of this trace, so many samples late.
  explicit DelayedTruth(const Trace& trace, int delay = 10)
      : truth_(std::make_shared<Eigen::MatrixXd>(trace.tau_ext)), delay_(delay) {}

  void reset() noexcept { next_ = 0; }
  Estimate<N> update(const Measurement<N>&) noexcept {
    const Eigen::Index k = next_++ - delay_;
    if (k < 0 || k >= truth_->cols()) return {};
    return {truth_->col(k)};
  }

 private:
  std::shared_ptr<const Eigen::MatrixXd> truth_;
  Eigen::Index delay_;
  Eigen::Index next_ = 0;
};

/// The truth itself: scores exactly 0.
template <int N>
class Truth : public DelayedTruth<N> {
 public:
  static constexpr const char* kName = "truth";
  /// The truth of this trace.
  explicit Truth(const Trace& trace) : DelayedTruth<N>(trace, 0) {}
};

/// Whether an estimator's specification is that of one that copies the recorded truth.
inline bool needs_truth(std::string_view estimator) {
  const std::string_view name = name_of_specification(estimator);
  return name == Truth<1>::kName || name == DelayedTruth<1>::kName;
}

/// Whether it is one of these, which stand outside the competition.
inline bool is_baseline(std::string_view estimator) {
  return name_of_specification(estimator) == Zero<1>::kName || needs_truth(estimator);
}

}  // namespace tauext
