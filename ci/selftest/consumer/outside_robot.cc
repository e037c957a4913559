// SPDX-License-Identifier: Apache-2.0
// A shared library with a robot of somebody else's, as a plug-in or a Python module would be: all
// of tauext has to be position-independent for it to link.
#include <bench/bench_main.h>
#include <bench/registry.h>
#include <estimators/testbed1.h>

extern "C" int run_with_robot(const char* mjcf, int argc, char** argv) {
  tauext::register_robot("outside_arm", tauext::Testbed1(), mjcf);
  return tauext::bench_main(argc, argv);
}
