// SPDX-License-Identifier: Apache-2.0
#include <bench/kit/kernels.h>

#include "mine.h"

TAUEXT_PLUGIN(kernels) {
  const tauext::WallMoBot3 arm;
  kernels.add_estimator("wallmobot3", arm, Mine(arm));
}
