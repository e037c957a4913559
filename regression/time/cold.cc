// SPDX-License-Identifier: Apache-2.0
#include "regression/time/cold.h"

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace tauext::gate {
namespace {

constexpr std::size_t kMemory = std::size_t{2} << 20, kLine = 64;
constexpr int kBranches = 128, kFunctions = 64;

volatile std::uint64_t sink;

// a branch each at an address of its own, taken or not
template <int I>
[[gnu::always_inline]] inline void branch(std::uint64_t random) {
  if (random >> (I % 64) & 1) sink = I;
}

template <int F, int... I>
[[gnu::noinline]] void branches(std::uint64_t random, std::integer_sequence<int, I...>) {
  (branch<F * kBranches + I>(random * (2 * I + 1)), ...);
}

template <int... F>
void all_branches(std::uint64_t& random, std::integer_sequence<int, F...>) {
  ((random = random * 6364136223846793005u + 1442695040888963407u,
    branches<F>(random, std::make_integer_sequence<int, kBranches>())),
   ...);
}

}  // namespace

void do_other_work() {
  static std::vector<unsigned char> memory(kMemory);
  static std::uint64_t random = 1;
  for (std::size_t i = 0; i < kMemory; i += kLine) ++memory[i];
  all_branches(random, std::make_integer_sequence<int, kFunctions>());
}

}  // namespace tauext::gate
