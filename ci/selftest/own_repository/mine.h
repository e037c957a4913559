// SPDX-License-Identifier: Apache-2.0
// The estimator of this repository: tau_ext as what momentum does beyond the model, through a
// low-pass.
#pragma once

#include <estimators/momentum_observer.h>
#include <estimators/wallmobot3.h>

class Mine {
 public:
  static constexpr const char* kName = "mine";
  static constexpr int kDof = 3;
  static constexpr double kBandwidth = 30;  ///< [rad/s]

  explicit Mine(const tauext::WallMoBot3& arm)
      : arm_(arm), observer_(arm, Observer::Parameters::for_bandwidth(arm, kBandwidth)) {}

  void reset() noexcept { observer_.reset(); }

  tauext::Estimate<3> update(const tauext::Measurement<3>& y) noexcept {
    // a comment
    return observer_.update(y);
  }

 private:
  using Observer = tauext::MomentumObserver<tauext::WallMoBot3>;
  tauext::WallMoBot3 arm_;
  Observer observer_;
};
