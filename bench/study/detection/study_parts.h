// SPDX-License-Identifier: Apache-2.0
/// @file
/// A study in parts: each into a file of its own, to which every finished piece adds a line. A part
/// that was interrupted, or killed, goes on where its file ends, and parts put together are to the
/// bit what one machine counts.
///
/// A file of a part has lines of JSON: first what is studied (kPartFormat), then for each piece its
/// number and what it added.
#pragma once

#include <cstddef>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "bench/study/detection/detection_study.h"

namespace tauext::study {

/// A file to which lines are added, each of them whole: whoever kills the program leaves at most
/// the last one unfinished. One writer at a time: another one is refused.
class Journal {
 public:
  /// Opens it, and makes it if it is not there.
  /// @throws std::runtime_error naming the path and the system's reason, or that another program
  /// writes it
  explicit Journal(const std::string& path);
  ~Journal();
  Journal(const Journal&) = delete;
  Journal& operator=(const Journal&) = delete;

  /// Forgets what is behind so many bytes, and goes on from there.
  void cut(std::size_t bytes);
  /// @param line without its end
  void add(std::string_view line);

 private:
  std::string path_;
  int fd_;
  std::size_t end_ = 0;  // [bytes] of whole lines
  bool broken_ = false;
};

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
  const Robot* robot = nullptr;  ///< that has runs
  std::string trained_on;        ///< Thresholds::trained_on
  double margin = 1;             ///< Thresholds::margin
  nlohmann::ordered_json plan;   ///< what was asked for, and a digest of the thresholds
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
