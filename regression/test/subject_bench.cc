// SPDX-License-Identifier: Apache-2.0
// The suite with `subject`, whose fault the environment variable SUBJECT names.
#include <cstdlib>

#include "bench/bench_main.h"
#include "bench/registry.h"
#include "regression/test/subject.h"

int main(int argc, char** argv) {
  const char* fault = std::getenv("SUBJECT");
  const std::string name = fault ? fault : "";
  tauext::register_estimator<tauext::Testbed1>(
      [name](const auto& arm) { return tauext::gate::test::Subject(arm, name); });
  return tauext::bench_main(argc, argv);
}
