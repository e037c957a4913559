// SPDX-License-Identifier: Apache-2.0
/// @file
/// Estimators of the paper that only have other parameters or models than ours: forms as it prints
/// them, to be compared with those that we stand for (kPrintedForm), and its EKF told what its
/// sensors are. What has a kFixedTuning is no tunable estimator, whatever its Parameters can do.
#pragma once

#include "estimators/ekf.h"
#include "estimators/ndob.h"
#include "estimators/testbed1.h"
#include "estimators/wallmobot3.h"

namespace tauext {

/// The testbed's EKF from x_0 = 0, as section 6.2 starts it, wherever the arm is.
struct EkfZeroStart : Ekf<Testbed1> {
  static constexpr const char* kName = "ekf_zero_start";
  static constexpr bool kPrintedForm = true, kFixedTuning = true;
  using Ekf::Ekf;
  /// The paper's, but for the start.
  static Parameters parameters() {
    Parameters p = Parameters::paper();
    p.start = Start::kZero;
    return p;
  }
};

/// The EKF with the printed sign(qd) for its friction.
struct EkfRawSign : Ekf<Testbed1> {
  static constexpr const char* kName = "ekf_raw_sign";
  static constexpr bool kPrintedForm = true, kFixedTuning = true;
  using Ekf::Ekf;
};

/// The NDOB with the printed sign(qd) for its friction.
struct NdobRawSign : Ndob<Testbed1> {
  static constexpr const char* kName = "ndob_raw_sign";
  static constexpr bool kPrintedForm = true, kFixedTuning = true;
  using Ndob::Ndob;
};

/// The EKF with the Q and R of the sensors instead of the printed ones: what the filter can do.
struct EkfHonest : Ekf<WallMoBot3> {
  static constexpr const char* kName = "ekf_honest";
  static constexpr bool kFixedTuning = true;
  using ComputesAs = Ekf<WallMoBot3>;  ///< in several runs at once
  using Ekf::Ekf;
};

}  // namespace tauext
