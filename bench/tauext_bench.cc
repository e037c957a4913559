// SPDX-License-Identifier: Apache-2.0
// tauext-bench: scores, then times every entry of the roster inside Google Benchmark.
#include "bench/bench_main.h"

int main(int argc, char** argv) {
  return tauext::bench_main(argc, argv);
}
