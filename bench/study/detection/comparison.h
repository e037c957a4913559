// SPDX-License-Identifier: Apache-2.0
/// @file
/// Which pairs of a study can be told apart, at one common operating point: each with its own
/// thresholds times the lowest factor that leaves no more than so many false alarms an hour.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <vector>

#include "bench/score/detection_metrics.h"
#include "bench/study/detection/study_counts.h"

namespace tauext::study {

inline constexpr double kCommonAlarms = 1;  ///< [1/h] the operating point

/// A pair, and what it found of some touches.
struct Standing {
  const Cell* cell;            ///< the pair
  double factor;               ///< [1] of kLevels, by which its thresholds are multiplied
  int found, touches;          ///< what it found
  metrics::Interval interval;  ///< of the share that it finds, 95 % (Wilson)

  double recall() const { return touches == 0 ? 0 : 1. * found / touches; }  ///< [1]
};

/// Pairs under one condition, on touches of one kind.
struct Comparison {
  std::string what;  ///< blows, all regions, a region, or a class of them
  bool of_class;     ///< whether it is one of region_classes()
  int touches;       ///< of each pair
  /// The best first. A group begins with its best pair, and has all whose intervals reach that
  /// one's; the best of the next group is worse than that of this one, with 95 % confidence each.
  std::vector<std::vector<Standing>> groups;
  std::vector<const Cell*> loud;  ///< which at no factor are that quiet
};

/// What is compared of cells of one condition: blows; then meetings with regions, all of them, by
/// region, and clamped; then by class.
std::vector<Comparison> compare(std::span<const Cell> cells);

/// The pair's names without their keys, where no other one of these has them; else as it is.
std::string short_name(const Cell& cell, std::span<const Cell> cells);

/// What was found of each kind of meeting with regions, as a table. @param cells of one condition
std::string format_regions(std::span<const Cell> cells);
std::string region_legend();      ///< what its columns mean
std::string comparison_legend();  ///< what those of format_comparisons() mean

/// All but the classes as a table. @param cells of one condition
std::string format_comparisons(std::span<const Cell> cells);

/// All of them. @param cells of one condition
nlohmann::ordered_json comparisons_json(std::span<const Cell> cells);

/// The cells of each condition, in their order.
std::vector<std::span<const Cell>> by_condition(const std::vector<Cell>& cells);

}  // namespace tauext::study
