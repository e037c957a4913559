// SPDX-License-Identifier: Apache-2.0
/// @file
/// What seeds say: means, their intervals, what lies between two entries; and tables of these.
#pragma once

#include <string>
#include <vector>

#include "bench/score/detection_metrics.h"
#include "bench/seeds/seeds.h"
#include "mjcf/trace/table_writer.h"

namespace tauext {

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
