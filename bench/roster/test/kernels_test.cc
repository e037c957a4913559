// SPDX-License-Identifier: Apache-2.0
#include "bench/roster/kernels/kernels.h"

#include <gtest/gtest.h>

#include "bench/roster/robots.h"
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
            "TAUEXT_LEVEL=x86-64-v3: this processor and this build have any, x86-64-v2; unset it "
            "for the best");
}

TEST(Kernels, ThisBuildHasOneForThisProcessor) {
  EXPECT_EQ(level(), detail::kernels().level);
  EXPECT_EQ(detail::all_kernels().front()->of_file.size(),
            static_cast<std::size_t>(kMaxFileJoints));
}

}  // namespace
}  // namespace tauext::test
