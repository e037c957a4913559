// SPDX-License-Identifier: Apache-2.0
/// @file
/// Whether a log's tau is rather held from t on or read at t (TorqueSampling), from a motion
/// without contact.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace tauext {

/// How much of the difference between both readings a log shows.
struct TorqueWeight {
  double weight = 0;  ///< [1] 0 if tau is held, 1 if it is read at instants; neither: cannot tell
  double sure = 0;    ///< [1] three standard errors
  Eigen::VectorXd held;     ///< [(N m)^2] mean square of the estimate by `held`, joint by joint
  Eigen::VectorXd instant;  ///< [(N m)^2] likewise of the other
  /// Whether that contradicts the reading that was assumed, beyond doubt.
  bool contradicts(bool assumed_instant) const;
  /// Whether the other reading is nearer, however far from both the log is.
  bool leans_from(bool assumed_instant) const;
};

/// Between one momentum observer's estimates by both readings lies a signal that is known; without
/// a contact the estimate by `held` is weight times that signal, and noise. A joint counts by its
/// weight's standard error, over as many fewer samples as the observer is slower than they.
class TorqueWeigher {
 public:
  /// For an arm of so many joints.
  explicit TorqueWeigher(int joints) : sums_(static_cast<std::size_t>(joints)) {}

  /// Estimates of a sample without contact by both readings, a number for each joint [N m]; only of
  /// one that was used.
  void take(const double* held, const double* instant);

  /// Nothing where there were fewer than 200 samples, or no joint moves.
  /// @param bandwidth [rad/s] of the observer
  /// @param step [s] from one sample to the next
  std::optional<TorqueWeight> weight(double bandwidth, double step) const;

 private:
  // of the estimate by `held` (a) and what it is above the other (d)
  struct Sums {
    double dd = 0, ad = 0, aa = 0;
  };
  std::vector<Sums> sums_;
  std::int64_t count_ = 0;
};

}  // namespace tauext
