// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <estimators/momentum_observer.h>
#include <estimators/wallmobot3.h>

// our own copy would do something of its own
struct Outside : tauext::MomentumObserver<tauext::WallMoBot3> {
  static constexpr const char* kName = "outside";
  explicit Outside(const tauext::WallMoBot3& arm) : MomentumObserver(arm) {}
};
