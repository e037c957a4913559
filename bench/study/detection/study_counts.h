// SPDX-License-Identifier: Apache-2.0
/// @file
/// What is counted of an estimator and a detector under one condition, and what one run adds to it.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "bench/roster/session/session.h"
#include "bench/study/study_runs.h"
#include "mjcf/scenarios/region_runs.h"
#include "mjcf/scenarios/touch.h"

namespace tauext::study {

/// Multiples of the detector's threshold at which its score is judged, too: from 1/8 to 8, four of
/// them in each octave.
inline constexpr auto kLevels = [] {
  std::array<double, 25> all{};
  for (std::size_t i = 0; i < all.size(); ++i) {
    constexpr std::array kInOctave = {1., 1.1892071150027210, 1.4142135623730951,
                                      1.6817928305074292};
    all[i] = kInOctave[i % 4] * static_cast<double>(1 << (i / 4)) / 8;
  }
  return all;
}();
/// How a detector with these thresholds is set whose score is judged at kLevels.
inline DetectorSettings judged_with(DetectorThresholds thresholds) {
  return {std::move(thresholds), kStartUp, 2 * kLevels.back()};
}
/// Of kLevels the one that is 1: the threshold itself.
inline constexpr std::size_t kOwnLevel = 12;
static_assert(kLevels[kOwnLevel] == 1);

/// What became of meetings of one of region_classes(). Times, distances and forces are rounded to
/// 1e-5.
struct RegionCount {
  int touches = 0, found = 0;       ///< found: by a mark until metrics::kGrace after the contact
  std::vector<double> delays;       ///< [s] from the begin of one that was found to its mark
  std::vector<double> moved;        ///< [m] moved_on() at that mark
  std::vector<double> peaks;        ///< [1] of the limit: the largest force of each
  std::vector<double> until_found;  ///< [1] of the limit: the same until the mark, if there was one
  std::array<int, kLevels.size()> found_at{};  ///< with thresholds times kLevels

  /// [1] of the touches in which the limit was exceeded before anything was marked.
  double exceeded() const;
};

/// One estimator and detector, by specification, under one condition.
struct Cell {
  std::string condition, estimator, detector;  ///< what was counted
  double Ts = 1e-3;                            ///< [s] from one sample that is seen to the next
  int runs = 0, failed_runs = 0;  ///< failed: an estimate was missing (any status but ok)
  int blows = 0, detected = 0;    ///< by a mark until metrics::kGrace after the blow
  int stray = 0;                  ///< marks in these runs outside such windows
  std::vector<double> delays;     ///< [s] from a detected blow's begin to its mark, rounded to 1e-5
  long quiet_samples = 0;         ///< of slow pushes and free motion
  long alarmed_samples = 0;       ///< of them, where the score is 1 or more
  int alarms = 0;                 ///< marks in them
  int collision_alarms = 0;       ///< those that say collision
  int brisk = 0, brisk_flagged = 0;               ///< brisk pushes, and those that were marked
  int clampings = 0, clampings_flagged = 0;       ///< by any mark while it holds
  int clampings_named = 0;                        ///< by a mark that says clamping
  std::array<int, kLevels.size()> detected_at{};  ///< with thresholds times kLevels
  std::array<int, kLevels.size()> alarms_at{};    ///< likewise

  std::vector<RegionCount> regions;  ///< by region_classes(); or empty

  /// Of the pair.
  std::string name() const { return estimator + "+" + detector; }
  /// [h] without a touch.
  double hours() const { return static_cast<double>(quiet_samples) * Ts / 3600; }
  /// The lowest of kLevels from which on upwards there are at most so many false alarms an hour;
  /// nothing if even the highest one has more, or nothing was quiet.
  std::optional<std::size_t> level_with(double alarms_per_hour) const;
  /// [1] of the blows.
  double recall() const { return blows == 0 ? 0 : static_cast<double>(detected) / blows; }
};

/// Its numbers that add up, by name.
inline constexpr auto kCellCounts = std::to_array<std::pair<const char*, int Cell::*>>({
    {"runs", &Cell::runs},
    {"failed_runs", &Cell::failed_runs},
    {"blows", &Cell::blows},
    {"detected", &Cell::detected},
    {"stray", &Cell::stray},
    {"alarms", &Cell::alarms},
    {"collision_alarms", &Cell::collision_alarms},
    {"brisk", &Cell::brisk},
    {"brisk_flagged", &Cell::brisk_flagged},
    {"clampings", &Cell::clampings},
    {"clampings_flagged", &Cell::clampings_flagged},
    {"clampings_named", &Cell::clampings_named},
});

/// Counts a run of that kind: what a detector said of it, against the touches that were there. Its
/// rises are through kLevels.
void count(TouchKind kind, const Answers& answers, const std::vector<Touch>& touches, Cell& cell);

/// Counts a run of meetings of that class.
/// @param force [N] on the arm at each sample, 1 kHz
/// @param moved of moved_on(), at each sample; empty: nobody asks how far
void count_regions(const RegionClass& of, const Answers& answers,
                   const std::vector<RegionTouch>& touches, const std::vector<double>& force,
                   const std::vector<double>& moved, RegionCount& to);

/// Adds a run to the sum; the names in `sum` stay.
void add(const Cell& run, Cell& sum);

/// Sorts delays and forces: their order is that in which runs ended.
void sort_values(Cell& sum);

}  // namespace tauext::study
