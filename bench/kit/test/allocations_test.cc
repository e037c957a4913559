// SPDX-License-Identifier: Apache-2.0
#include "bench/kit/allocations.h"

#include <benchmark/benchmark.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <memory>
#include <vector>

namespace tauext::test {
namespace {

// allocations that a call makes
template <class Call>
std::uint64_t count(Call&& call) {
  const auto before = allocations();
  call();
  return allocations() - before;
}

TEST(Allocations, AreCountedByWhateverWayTheyCome) {
  if (!allocations_are_counted()) {
    EXPECT_EQ(count([] { benchmark::DoNotOptimize(std::make_unique<int>(1)); }), 0u)
        << "a sanitizer's malloc";
    return;
  }
  EXPECT_EQ(count([] { benchmark::DoNotOptimize(std::make_unique<int>(1)); }), 1u);
  EXPECT_EQ(count([] { benchmark::DoNotOptimize(std::vector<double>(100)); }), 1u);
  EXPECT_EQ(count([] {
              void* p = std::malloc(10);
              benchmark::DoNotOptimize(p);
              p = std::realloc(p, 1000);
              benchmark::DoNotOptimize(p);
              std::free(p);
            }),
            2u);
  EXPECT_EQ(count([] {
              void* p = nullptr;
              ASSERT_EQ(posix_memalign(&p, 64, 100), 0);
              benchmark::DoNotOptimize(p);
              std::free(p);
            }),
            1u)
      << "the way of Eigen's dynamic matrices";
  EXPECT_EQ(count([] {}), 0u);
}

}  // namespace
}  // namespace tauext::test
