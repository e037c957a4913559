// SPDX-License-Identifier: Apache-2.0
// The estimator of twice.h beside the others. Run
//   own_estimator --benchmark_filter=wallmobot3/step/ --estimator twice,twice:pole=30,twice:pole=90
//   own_estimator --equal-bandwidth 30     it stands beside the others at one bandwidth
#include "bench/bench_main.h"
#include "bench/registry.h"
#include "twice.h"

int main(int argc, char** argv) {
  const auto twice = [](const auto& arm) { return own::Twice(arm); };
  tauext::register_estimator<tauext::WallMoBot3>(twice);
  tauext::register_file_estimator(twice);
  return tauext::bench_main(argc, argv);
}
