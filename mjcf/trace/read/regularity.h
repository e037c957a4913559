// SPDX-License-Identifier: Apache-2.0
/// @file
/// How regular the samples of a recording are: gaps, jitter, repeats.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>

namespace tauext {

/// How regular the samples of a recording are.
struct Regularity {
  std::int64_t samples = 0;  ///< all
  double from = 0, to = 0;   ///< [s] of t
  double step = 0;           ///< [s] mean, gaps left aside
  double jitter = 0;         ///< [s] standard deviation of it
  std::int64_t gaps = 0;     ///< steps of more than 8 such, at most two in a row
  double longest_gap = 0;    ///< [s]
  std::int64_t repeats = 0;  ///< samples whose q, qd and tau are those of the one before
  /// In a sentence.
  std::string in_words() const;
};

/// Counts as samples go by, in constant memory.
class RegularityCounter {
 public:
  /// The next sample: t [s], q [rad], qd [rad/s], tau [N m].
  void take(double t, const Eigen::VectorXd& q, const Eigen::VectorXd& qd,
            const Eigen::VectorXd& tau);
  const Regularity& so_far() const { return r_; }  ///< of those that were taken

 private:
  void take_step(double h);

  Regularity r_;
  std::int64_t steps_ = 0,
               in_a_row_ = 0;  // steps that are none of the gaps; gaps one behind another
  double longest_before_ = 0;  // [s] gap before these
  double squares_ = 0;         // [s^2]
  Eigen::VectorXd q_, qd_, tau_;
};

}  // namespace tauext
