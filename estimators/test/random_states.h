// SPDX-License-Identifier: Apache-2.0
// A fixture that draws states, the same ones on every run.
#pragma once

#include <gtest/gtest.h>

#include <random>

#include "estimators/types.h"

namespace tauext::test {

class RandomStates : public testing::Test {
 protected:
  /// Three numbers in +-scale.
  Vec<3> vector(double scale) {
    std::uniform_real_distribution<double> u(-scale, scale);
    const double a = u(generator_), b = u(generator_), c = u(generator_);
    return {a, b, c};
  }

 private:
  std::mt19937_64 generator_{7};
};

}  // namespace tauext::test
