// SPDX-License-Identifier: Apache-2.0
// An estimator of somebody else's in the whole table, and held to what ours are held to.
#include "outside.h"

#include <bench/bench_main.h>
#include <bench/registry.h>

int main(int argc, char** argv) {
  tauext::register_estimator<tauext::WallMoBot3>([](const auto& arm) { return Outside(arm); });
  return tauext::bench_main(argc, argv);
}
