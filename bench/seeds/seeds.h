// SPDX-License-Identifier: Apache-2.0
/// @file
/// Scores over the seeds of the sensors: means, their intervals, and what lies between two entries.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "bench/score/detection_metrics.h"
#include "bench/score/suite.h"
#include "mjcf/trace/table_writer.h"

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

/// Scores entries over seeds, again and again: truths are simulated once.
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
  std::map<std::string, std::unique_ptr<Suite>> suites_;  // by group
};

/// The same, once.
/// @throws std::invalid_argument without a seed
std::vector<SeededRow> score_over_seeds(const SeedOptions& options);

/// What seeds say of a metric.
struct SeedFigure {
  double mean = 0;             ///< over the seeds that have a value
  metrics::Interval interval;  ///< of 95 %
  int values = 0;              ///< seeds with one
  int never = 0;               ///< seeds without one, of which it was asked ("never settles")
};

/// [1] Student's t of so many degrees of freedom, 1 or more, that 97.5 % of values do not exceed.
double student_t(int degrees);

/// The mean of values and its interval by Student's t; infinite for a single value.
SeedFigure figure_of(const std::vector<double>& values);

/// The same of an entry's metric. A recall has Wilson's interval over the collisions of all seeds,
/// and a number of false alarms Garwood's.
SeedFigure figure_of(const SeededRow& row, Metric metric);

/// One entry's metric minus the other's, seed by seed, where both have a value.
SeedFigure difference_of(const SeededRow& row, const SeededRow& against, Metric metric);

/// For people a table of means and one of differences; for programs a row for each entry and
/// metric.
/// @param against the estimator that others of its group are compared with, behind their own
/// detector; or ESTIMATOR+DETECTOR
std::string format_seeds(const std::vector<SeededRow>& rows, const std::string& against,
                         TableFormat format = TableFormat::kText);

}  // namespace tauext
