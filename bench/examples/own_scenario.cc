// SPDX-License-Identifier: Apache-2.0
// A scenario of your own: somebody knocks on the panel, twice a second. Run
//   own_scenario --benchmark_filter=wallmobot3/knock/
#include "bench/bench_main.h"
#include "mjcf/scenarios/scenario.h"
#include "mjcf/scenarios/touch.h"

int main(int argc, char** argv) {
  using namespace tauext;
  Scenario knock = quiet();
  knock.name = "knock";
  knock.description = "blows of 150 N and 15 ms against the panel, twice a second from 5 s on";
  knock.response = Response::kDetection;
  knock.reference = [](double t, int) { return sine_motion(0.1, 1, t); };  // [rad] of every joint
  std::vector<Touch> knocks;
  for (double t = 5; t < 25; t += 0.5) {
    knocks.push_back({.begin = t, .rise = 0.015, .force = Eigen::Vector3d(-150, 0, 0)});
  }
  register_scenario("wallmobot3", with_touches(knock, knocks));
  return bench_main(argc, argv);
}
