// SPDX-License-Identifier: Apache-2.0
/// @file
/// Every metric of the suite, defined once. A signal is one joint's row over the samples; `truth`
/// and `estimate` are tau_ext [N m]; NaN says that a metric does not exist for these signals.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "mjcf/trace.h"

namespace tauext {

using Signal = Eigen::Ref<const Eigen::RowVectorXd, 0, Eigen::InnerStride<>>;
using Times = std::vector<double>;  ///< [s], increasing

/// [N m] root of the mean squared error over samples with t >= from.
double rmse(const Times& t, const Signal& truth, const Signal& estimate, double from);

/// [N m] mean of estimate - truth over samples with t >= from.
double bias(const Times& t, const Signal& truth, const Signal& estimate, double from);

/// [N m] largest |estimate - truth| over samples with t >= from.
double max_error(const Times& t, const Signal& truth, const Signal& estimate, double from);

/// [s] when |estimate - truth| is largest, over samples with t >= from; NaN without a sample.
double time_of_max_error(const Times& t, const Signal& truth, const Signal& estimate, double from);

/// [N m] what sensor noise adds: standard deviation of noisy - ideal, two estimates of one run, over
/// samples with t >= from.
double noise(const Times& t, const Signal& ideal, const Signal& noisy, double from);

/// [N m] mean of estimate - truth over the last second: where an estimate ends up.
double final_error(const Times& t, const Signal& truth, const Signal& estimate);

/// The answer to the largest jump of the truth, from level a to level b at time t_s. A crossing
/// lies on the straight line between two samples.
struct StepResponse {
  double rise;       ///< [s] from first reaching 10 % to first reaching 90 % of the way from a to b
  double rise_0_90;  ///< [s] from t_s to first reaching 90 %
  double
      settling;  ///< [s] from t_s to last entering b +- 2 % of b - a; NaN if it never stays there
  double overshoot;  ///< [%] of b - a, beyond b; at least 0
};
StepResponse step_response(const Times& t, const Signal& truth, const Signal& estimate);

/// [s] the delay L, at sample resolution and up to 2 s, for which truth(t - L) is closest to
/// estimate(t) in the mean square over t >= from + 2 s. NaN for a constant truth or estimate, for a
/// shorter run, and if no delay below 2 s fits best.
double lag(const Times& t, const Signal& truth, const Signal& estimate, double from);

/// [rad/s] -3 dB: the frequency at which the estimate's answer to a swept sine first falls below
/// 1/sqrt(2) of the truth, from 0.7 to 280 rad/s. The answer is the cross spectrum over the truth's own
/// spectrum, each a mean over a band of 10 %. NaN if it does not fall or already has at 0.7 rad/s, if the
/// truth does not cover these frequencies, or if samples are not evenly spaced (within 1 %).
double bandwidth(const Times& t, const Signal& truth, const Signal& estimate);

/// Marks against the true contact. A collision lasts from the first to the last sample of a run of
/// contact = 1. It is detected by the first mark from its begin until 0.2 s after its end; any mark
/// outside these windows is a false alarm.
struct DetectionScore {
  int collisions = 0;
  int detected = 0;
  int false_alarms = 0;
  double delay = 0;                  ///< [s] largest delay of a detected collision; NaN without one
  double false_alarms_per_hour = 0;  ///< [1/h]
};
DetectionScore detection_score(const Times& t, const std::vector<std::uint8_t>& contact,
                               const std::vector<std::uint8_t>& marks);

/// [rad] how far an arm moves on, in the direction in which it moved, after a mark stopped its motor at
/// sample trace.stopped_at: the largest of its joints. NaN if nothing stopped it.
double overtravel(const Trace& trace);

/// [N] the largest force of a contact; 0 without a sample.
double peak(const std::vector<double>& force);

/// Smallest of the values that at least `share` of them do not exceed; NaN without a value.
double quantile(std::vector<double> values, double share);

/// The rate that can be excluded at 95 % if `count` events were seen: with a mean of poisson_upper(count)
/// so few or fewer are seen in 5 % of all trials (Garwood 1936). 3.0 for none.
double poisson_upper(int count);

}  // namespace tauext
