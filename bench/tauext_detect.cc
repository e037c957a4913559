// SPDX-License-Identifier: Apache-2.0
// tauext-detect: calibrates the detectors, and studies every one behind every estimator.
#include "bench/detect_main.h"

int main(int argc, char** argv) {
  return tauext::detect_main(argc, argv);
}
