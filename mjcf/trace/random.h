// SPDX-License-Identifier: Apache-2.0
/// @file
/// Random numbers that are the same with every standard library: std::normal_distribution and
/// std::uniform_real_distribution have sequences of their own in each.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <random>
#include <vector>

namespace tauext {

/// One generator for each seed and channel.
class Random {
 public:
  /// Another sequence for every pair of seed and channel.
  explicit Random(std::uint64_t seed, std::uint64_t channel = 0) {
    std::seed_seq seeds{static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32),
                        static_cast<std::uint32_t>(channel)};
    generator_.seed(seeds);
  }

  /// In (0, 1].
  double uniform() { return (static_cast<double>(generator_() >> 11) + 1) * 0x1p-53; }

  /// In (from, to].
  double uniform(double from, double to) { return from + (to - from) * uniform(); }

  /// N(0, 1) by Box and Muller.
  double normal() {
    const double u = uniform(), v = uniform();
    return std::sqrt(-2 * std::log(u)) * std::cos(2 * std::numbers::pi * v);
  }

 private:
  std::mt19937_64 generator_;
};

/// The normal numbers of a Random, each drawn once, whoever asks for it.
class Normals {
 public:
  /// Those of Random(seed, channel).
  explicit Normals(std::uint64_t seed, std::uint64_t channel = 0) : random_(seed, channel) {}

  /// The k-th, from 0.
  double operator[](std::size_t k) {
    while (k >= drawn_.size()) drawn_.push_back(random_.normal());
    return drawn_[k];
  }

 private:
  Random random_;
  std::vector<double> drawn_;
};

}  // namespace tauext
