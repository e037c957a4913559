// SPDX-License-Identifier: Apache-2.0
#include <bench/bench_main.h>
#include <bench/registry.h>

#include "mine.h"

int main(int argc, char** argv) {
  tauext::register_estimator<tauext::WallMoBot3>([](const auto& arm) { return Mine(arm); });
  return tauext::bench_main(argc, argv);
}
