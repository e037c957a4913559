// SPDX-License-Identifier: Apache-2.0
/// @file
/// How long something took, a million times, without keeping a million numbers.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cmath>
#include <cstdint>

namespace tauext::live {

/// Counts of times in buckets 1/16 wide (6 %) of their value. One thread adds, any reads; allocates
/// nothing.
class Histogram {
 public:
  /// One more duration [ns].
  void add(std::int64_t ns) noexcept {
    const auto value = static_cast<std::uint64_t>(std::max<std::int64_t>(ns, 0));
    bump(buckets_[bucket(value)]);
    bump(count_);
    if (value > largest_.load(std::memory_order_relaxed)) {
      largest_.store(value, std::memory_order_relaxed);
    }
  }

  /// How many there are.
  std::uint64_t count() const noexcept { return count_.load(std::memory_order_relaxed); }
  /// [ns]
  double largest() const noexcept {
    return static_cast<double>(largest_.load(std::memory_order_relaxed));
  }

  /// [ns] what this share of the values does not exceed, exact to a bucket and straight within it;
  /// 0 without one.
  double quantile(double share) const noexcept {
    const double wanted = std::ceil(share * static_cast<double>(count()));
    double seen = 0;
    for (int b = 0; b < kBuckets; ++b) {
      const auto here = static_cast<double>(buckets_[b].load(std::memory_order_relaxed));
      seen += here;
      if (seen < wanted || here == 0) continue;
      const double lower = b == 0 ? 0 : upper_edge(b - 1) + 1, upper = upper_edge(b);
      return std::min(upper - (upper - lower) * (seen - wanted) / here, largest());
    }
    return largest();
  }

 private:
  using Cell = std::atomic<std::uint64_t>;
  static constexpr int kBuckets = 16 * 61;

  // one thread writes: no locked instruction is needed
  static void bump(Cell& c) noexcept {
    c.store(c.load(std::memory_order_relaxed) + 1, std::memory_order_relaxed);
  }
  static int bucket(std::uint64_t v) noexcept {
    if (v < 16) return static_cast<int>(v);
    const int shift = std::bit_width(v) - 5;  // leaves 16 to 31
    return 16 * shift + static_cast<int>(v >> shift);
  }
  static double upper_edge(int b) noexcept {
    if (b < 32) return b;
    const int shift = b / 16 - 1;
    return std::ldexp(b % 16 + 17, shift) - 1;
  }

  std::array<Cell, kBuckets> buckets_{};
  Cell count_ = 0, largest_ = 0;
};

}  // namespace tauext::live
