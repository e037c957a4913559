// SPDX-License-Identifier: Apache-2.0
#include "bench/roster/kernels/kernels.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cstdlib>
#include <stdexcept>

namespace tauext::detail {
namespace {

// what all else is compiled for runs, or nobody would ask
bool runs_here([[maybe_unused]] const std::string& level) {
#ifdef __x86_64__
  __builtin_cpu_init();
  if (level == "x86-64-v2")
    return __builtin_cpu_supports("sse4.2") && __builtin_cpu_supports("popcnt");
  if (level == "x86-64-v3") {
    return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") &&
           __builtin_cpu_supports("bmi2");
  }
  if (level == "x86-64-v4") {
    return __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512cd") &&
           __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl");
  }
#endif
  return true;
}

std::string name_of(const std::string& level) {
  return level.empty() ? "any" : level;
}

}  // namespace

const Kernels& choose(const std::vector<const Kernels*>& all, bool (*runs)(const std::string&),
                      const std::string& asked) {
  const Kernels* best = nullptr;
  std::vector<std::string> known;
  for (const Kernels* k : all) {
    if (!runs(k->level)) continue;
    known.push_back(name_of(k->level));
    if (asked.empty() || asked == known.back()) best = k;
  }
  if (best != nullptr) return *best;
  if (known.empty())
    throw std::invalid_argument(
        fmt::format("this build is for {}, and this processor is not; CMake's TAUEXT_LEVELS builds "
                    "for several",
                    all.front()->level));
  throw std::invalid_argument(fmt::format(
      "TAUEXT_LEVEL={}: no such level here; this build and this processor both have {}; "
      "unset it to take the best one",
      asked, fmt::join(known, ", ")));
}

const Kernels& kernels() {
  static const Kernels& best = []() -> const Kernels& {
    const char* const asked = std::getenv("TAUEXT_LEVEL");
    return choose(all_kernels(), runs_here, asked == nullptr ? "" : asked);
  }();
  return best;
}

}  // namespace tauext::detail
