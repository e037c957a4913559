// SPDX-License-Identifier: Apache-2.0
#include "bench/roster/kernels/kernels.h"

#include <gtest/gtest.h>

#include "mjcf/test/error_of.h"

namespace tauext::test {
namespace {

using detail::choose, detail::Kernels;

TEST(Kernels, TheHighestLevelThatRunsIsTaken) {
  const Kernels any{"", {}, nullptr, nullptr}, v2{"x86-64-v2", {}, nullptr, nullptr},
      v3{"x86-64-v3", {}, nullptr, nullptr};
  const std::vector<const Kernels*> all = {&any, &v2, &v3};
  const auto every = [](const std::string&) { return true; };
  const auto old = [](const std::string& level) { return level != "x86-64-v3"; };
  EXPECT_EQ(&choose(all, every, ""), &v3);
  EXPECT_EQ(&choose(all, old, ""), &v2);
  EXPECT_EQ(&choose(all, every, "x86-64-v2"), &v2);
  EXPECT_EQ(&choose(all, every, "any"), &any);
  EXPECT_EQ(error_of([&] { choose(all, old, "x86-64-v3"); }),
            "TAUEXT_LEVEL=x86-64-v3: no such level here; this build and this processor both have "
            "any, x86-64-v2; unset it to take the best one");
}

TEST(Kernels, ABuildForABetterProcessorSaysSo) {
  const Kernels v4{"x86-64-v4", {}, nullptr, nullptr};
  const auto none = [](const std::string&) { return false; };
  EXPECT_EQ(error_of([&] { choose({&v4}, none, ""); }),
            "this build is for x86-64-v4, and this processor is not; CMake's TAUEXT_LEVELS builds "
            "for several");
}

TEST(Kernels, OfEachLevelAreWholeAndInOrder) {
  std::string before;
  for (const Kernels* k : detail::all_kernels()) {
    EXPECT_TRUE(k == detail::all_kernels().front() || before < k->level) << k->level;
    before = k->level;
    for (const auto make : k->of_file) EXPECT_NE(make, nullptr) << k->level;
    EXPECT_TRUE(k->wallmobot3 != nullptr && k->testbed1 != nullptr) << k->level;
  }
}

}  // namespace
}  // namespace tauext::test
