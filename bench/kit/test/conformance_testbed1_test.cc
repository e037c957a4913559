// SPDX-License-Identifier: Apache-2.0
// What every estimator of testbed1 must do, whoever wrote it.
#include <gtest/gtest.h>

#include "bench/kit/conformance.h"
#include "bench/kit/test/every_estimator.h"

namespace tauext::test {
namespace {

TEST(EveryEstimatorOfTestbed1, Conforms) {
  const int count = for_every_estimator<Testbed1>(
      [](auto make) { conformance::check_estimator(Testbed1(), make); });
  EXPECT_GE(count, 10);
}

}  // namespace
}  // namespace tauext::test
