// SPDX-License-Identifier: Apache-2.0
/// @file
/// A study in parts: each into a file of its own, to which every finished piece adds a line. A part
/// that was interrupted, or killed, goes on where its file ends, and parts put together are to the
/// bit what one machine counts.
///
/// A file of a part has lines of JSON: first what is studied (kPartFormat), then for each piece its
/// number and what it added.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "bench/study/detection/detection_study.h"

namespace tauext::study {

inline constexpr const char* kPartFormat = "tauext-detection-part-2";  ///< of its first line

/// The index-th of `count` parts, counted from 1: every count-th piece.
struct Shard {
  int index = 1;  ///< 1 to count
  int count = 1;  ///< 1 or more
};

/// @param text like 2/7
/// @throws std::invalid_argument for anything else
Shard shard_of(const std::string& text);

/// What a study is of, and where it runs.
struct StudyAbout {
  std::string robot;            ///< by which robot() finds it
  std::string trained_on;       ///< Thresholds::trained_on
  double margin = 1;            ///< Thresholds::margin
  nlohmann::ordered_json plan;  ///< what was asked for, and a digest of the thresholds
  std::vector<std::pair<std::string, std::string>> context;  ///< provenance(), of one part
};

/// Without a context.
StudyAbout about(const StudyOptions& options, const Thresholds& thresholds);

/// Runs what is missing of a part.
/// @param path its file; what is in it already is not done again
/// @param options its threads, progress and stop
/// @return whether nothing is missing any more
/// @throws std::runtime_error naming the file, if it cannot be written, or is no part, or one of
/// another study
bool run_part(const DetectionStudy& study, const StudyAbout& about, const Shard& shard,
              const std::string& path, const StudyOptions& options);

/// A study that was put together.
struct Merged {
  StudyAbout about;         ///< of its first part
  std::vector<Cell> cells;  ///< sorted
};

/// Puts parts together, in any order.
/// @throws std::runtime_error naming the file for what is no part, parts of different studies, a
/// part that is there twice, and pieces that are missing
Merged merge_parts(const std::vector<std::string>& paths);

}  // namespace tauext::study
