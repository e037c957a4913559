// SPDX-License-Identifier: Apache-2.0
// Whether the estimator of twice.h keeps what every estimator promises, one run and several.
#include <gtest/gtest.h>

#include "bench/kit/conformance.h"
#include "estimators/wallmobot3.h"
#include "twice.h"

TEST(Twice, Conforms) {
  const tauext::WallMoBot3 arm;
  static_assert(tauext::ForRuns<own::Twice<tauext::WallMoBot3>>);
  tauext::conformance::check_estimator(arm, [&] { return own::Twice(arm); });
}
