// SPDX-License-Identifier: Apache-2.0
/// @file
/// How fast an estimate is, of its answer to a swept sine.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace tauext::metrics {

/// A row of a matrix: a value for each sample.
using Signal = Eigen::Ref<const Eigen::RowVectorXd, 0, Eigen::InnerStride<>>;
using Times = std::vector<double>;  ///< [s], increasing

/// [rad/s] -3 dB: the frequency at which the estimate's answer to a swept sine first falls below
/// 1/sqrt(2) of the truth, from 0.7 to 280 rad/s. The answer is the cross spectrum over the truth's
/// own spectrum, each a mean over a band of 10 %. NaN if it does not fall or already has at 0.7
/// rad/s, if the truth does not cover these frequencies, or if samples are not evenly spaced
/// (within 1 %).
double bandwidth(const Times& t, const Signal& truth, const Signal& estimate);

}  // namespace tauext::metrics
