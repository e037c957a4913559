// SPDX-License-Identifier: Apache-2.0
/// @file
/// A trace of an arm at rest.
#pragma once

#include <Eigen/Core>

#include "mjcf/trace/trace.h"

namespace tauext::test {

/// Three joints at 0.12345 rad, without torque; a sample each millisecond.
inline Trace still(int samples) {
  Trace t;
  for (int k = 0; k < samples; ++k) t.t.push_back(k * 1e-3);
  t.q = Eigen::MatrixXd::Constant(3, samples, 0.12345);
  t.qd = t.tau = t.tau_ext = Eigen::MatrixXd::Zero(3, samples);
  return t;
}

}  // namespace tauext::test
