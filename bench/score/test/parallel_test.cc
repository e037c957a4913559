// SPDX-License-Identifier: Apache-2.0
#include "bench/score/parallel.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace tauext::test {
namespace {

TEST(Mixed, IsAnOrderOfAllNumbers) {
  for (int n = 1; n < 500; ++n) {
    std::vector<int> seen;
    for (int i = 0; i < n; ++i) seen.push_back(mixed(i, n));
    std::sort(seen.begin(), seen.end());
    for (int i = 0; i < n; ++i) ASSERT_EQ(seen[static_cast<std::size_t>(i)], i) << "of " << n;
  }
}

TEST(Mixed, TellsAfterATenthHowMuchIsLeft) {
  // the first third of the work takes ten times as long as the rest
  for (const int n : {100, 137, 1000}) {
    double all = 0, begun = 0;
    for (int i = 0; i < n; ++i) {
      const double costs = mixed(i, n) < n / 3 ? 10 : 1;
      all += costs;
      if (i < n / 10) begun += costs;
    }
    EXPECT_NEAR(begun * n / (n / 10) / all, 1, 0.25) << "of " << n << "; in order it is 2.5";
  }
}

}  // namespace
}  // namespace tauext::test
