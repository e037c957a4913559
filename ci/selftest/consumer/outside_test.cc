// SPDX-License-Identifier: Apache-2.0
#include "outside.h"

#include <bench/kit/conformance.h>
#include <estimators/detectors/threshold.h>

TEST(Outside, Conforms) {
  tauext::conformance::check_estimator(tauext::WallMoBot3(),
                                       [] { return Outside(tauext::WallMoBot3()); });
  tauext::conformance::check_detector([] { return tauext::Threshold<3>(); });
}
