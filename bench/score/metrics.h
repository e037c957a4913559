// SPDX-License-Identifier: Apache-2.0
/// @file
/// The metrics of estimates, each defined once. A signal is one joint's row over the samples;
/// `truth` and `estimate` are tau_ext [N m]; NaN says that a metric does not exist for these
/// signals.
#pragma once

#include <Eigen/Core>
#include <cmath>

#include "bench/roster/pair.h"
#include "bench/score/bandwidth.h"
#include "bench/score/score.h"
#include "mjcf/arm_forces.h"
#include "mjcf/scenarios/scenario.h"
#include "mjcf/trace/trace.h"

namespace tauext {
namespace metrics {

/// Errors of one joint's estimates, estimate - truth [N m], as they come.
class Errors {
 public:
  /// The next one.
  void take(double error) {
    ++count_;
    sum_ += error;
    squares_ += error * error;
    if (std::abs(error) > max_) max_ = std::abs(error);
  }
  double rmse() const { return count_ == 0 ? kNoValue : std::sqrt(squares_ / count_); }  ///< [N m]
  double bias() const { return count_ == 0 ? kNoValue : sum_ / count_; }  ///< [N m] mean
  double max() const { return count_ == 0 ? kNoValue : max_; }            ///< [N m] largest size

 private:
  double count_ = 0, sum_ = 0, squares_ = 0, max_ = 0;
};

/// [N m] root of the mean squared error over samples with t >= from.
double rmse(const Times& t, const Signal& truth, const Signal& estimate, double from);

/// [N m] mean of estimate - truth over samples with t >= from.
double bias(const Times& t, const Signal& truth, const Signal& estimate, double from);

/// [N m] largest |estimate - truth| over samples with t >= from.
double max_error(const Times& t, const Signal& truth, const Signal& estimate, double from);

/// [s] when |estimate - truth| is largest, over samples with t >= from; NaN without a sample.
double time_of_max_error(const Times& t, const Signal& truth, const Signal& estimate, double from);

/// [N m] what sensor noise adds: standard deviation of noisy - ideal, two estimates of one run,
/// over samples with t >= from.
double noise(const Times& t, const Signal& ideal, const Signal& noisy, double from);

/// [N m] mean of estimate - truth over the last second: where an estimate ends up.
double final_error(const Times& t, const Signal& truth, const Signal& estimate);

/// The answer to the largest jump of the truth, from level a to level b at time t_s, until it jumps
/// again (by half as much or more). A crossing lies on the straight line between two samples.
struct StepResponse {
  double rise;       ///< [s] from first reaching 10 % to first reaching 90 % of the way from a to b
  double rise_0_90;  ///< [s] from t_s to first reaching 90 %
  double
      settling;  ///< [s] from t_s to last entering b +- 2 % of b - a; NaN if it never stays there
  double overshoot;  ///< [%] of b - a, beyond b; at least 0
};
/// The answer of that estimate to that truth.
StepResponse step_response(const Times& t, const Signal& truth, const Signal& estimate);

inline constexpr double kLongestLag = 2;  ///< [s] that lag() looks for

/// [s] the delay L, at sample resolution and up to kLongestLag, for which truth(t - L) is closest
/// to estimate(t) in the mean square over t >= from + kLongestLag. Of a truth that repeats, the
/// least such delay. NaN for a constant truth or estimate, for a shorter run, if no shorter delay
/// fits best, and if the truth is so small beside the noise that no delay stands out (by 3 sigma).
double lag(const Times& t, const Signal& truth, const Signal& estimate, double from);

/// [N] root of the mean squared error of the force at the end effector that estimates mean, over
/// samples with t >= from: beside what the joints see of the true one (estimators/force/). NaN if
/// the trace has no force.
double force_rmse(const ArmForces& arm, const Trace& trace, const Eigen::MatrixXd& estimate,
                  double from);

}  // namespace metrics

/// The errors of a trace's estimates, over samples with t >= from [s].
void add_error_metrics(const Trace& trace, const Output& output, double from, Score& score);

/// What sensor noise adds: two estimates of one run, over samples with t >= from [s]. Nothing if
/// samples were dropped, so that the two are of different lengths.
void add_noise_metric(const Trace& trace, const Output& ideal, const Output& noisy, double from,
                      Score& score);

/// What scenario.response asks for.
void add_response_metrics(const Trace& trace, const Output& output, const Scenario& scenario,
                          Score& score);

}  // namespace tauext
