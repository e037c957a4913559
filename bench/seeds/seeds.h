// SPDX-License-Identifier: Apache-2.0
/// @file
/// Scores over the seeds of the sensors.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "bench/score/suite.h"

namespace tauext {

/// What is scored, and how often.
struct SeedOptions {
  SuiteOptions suite;                    ///< whose sensors draw by the seeds
  std::vector<Entry> entries;            ///< what runs
  std::vector<std::uint64_t> seeds;      ///< of the sensors; not empty
  int threads = 0;                       ///< 0: one a core
  std::function<void(double)> progress;  ///< called with the share that is done; may be empty
};

/// An entry, and what it is worth at each seed, in their order.
struct SeededRow {
  Entry entry;                ///< what was run
  std::vector<Score> scores;  ///< by seed
};

/// Scores entries over seeds, again and again: truths are simulated once, or, of fewer groups than
/// threads, once a thread.
class SeedScorer {
 public:
  /// @param suite whose sensors draw by the seeds
  /// @param threads 0: one a core
  /// @throws std::invalid_argument without a seed
  SeedScorer(const SuiteOptions& suite, std::vector<std::uint64_t> seeds, int threads = 0);

  /// The rows of all entries, in their order.
  /// @param progress called with the share that is done; may be empty
  std::vector<SeededRow> operator()(const std::vector<Entry>& entries,
                                    const std::function<void(double)>& progress = nullptr);

 private:
  SuiteOptions options_;
  std::vector<std::uint64_t> seeds_;
  int threads_;
  std::map<std::string, std::vector<std::unique_ptr<Suite>>> suites_;  // by group
};

/// The same, once.
/// @throws std::invalid_argument without a seed
std::vector<SeededRow> score_over_seeds(const SeedOptions& options);

}  // namespace tauext
