// SPDX-License-Identifier: Apache-2.0
/// @file
/// A recording as it lies in its file: rows of numbers in named columns, read one by one, so that
/// the memory that it takes does not grow with its length.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "mjcf/trace/timed_rows.h"

namespace tauext {

/// The rows of a file of some format. What the columns mean is said elsewhere (column_map.h).
class RowSource {
 public:
  virtual ~RowSource() = default;

  /// Their names, each once, in the order of a row.
  virtual const std::vector<std::string>& columns() const = 0;
  /// The next row that can be read, of as many numbers as there are columns; a number that the row
  /// does not have is NaN. Rows that cannot be read are counted in `skipped`, with their reason.
  /// @returns false at the end
  /// @throws std::runtime_error naming the path and what is wrong, where no further row can be read
  virtual bool next(std::vector<double>& row, SkippedRows& skipped) = 0;
  /// Columns that matter, by their numbers from 0: the others may be NaN, and are not judged.
  virtual void read_only([[maybe_unused]] const std::vector<int>& wanted) {}
  /// Columns that are not judged, either, and yet read where they hold numbers.
  virtual void look_at([[maybe_unused]] const std::vector<int>& columns) {}
  /// Where that row stands in the file, from 1, as a user counts.
  virtual long number() const = 0;
  /// What has that number: "line", "message", "row".
  virtual std::string_view unit() const = 0;
};

}  // namespace tauext
