// SPDX-License-Identifier: Apache-2.0
/// @file
/// Recordings as MATLAB saves them: .mat of the versions 5 (also as v6 and v7) and 7.3.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "mjcf/trace/read/row_source.h"

namespace tauext {

/// Whether bytes that begin a file are those of such a .mat.
bool begins_as_mat(std::string_view begin);

/// The rows of a .mat, whatever its name is. libmatio reads it, in a child process with limits
/// (confined.h), for it is not made for files that nobody vouches for. So it has to fit into
/// memory: up to 2 GB of numbers.
///
/// Its columns are its variables side by side: a vector t is the column t, and q of shape (n, k) or
/// (k, n) is q1 .. qk. Fields of a structure are called by their path, log.q1, and those of an
/// array of structures log(1).q1. n is the length of the vector whose last name is t or time or,
/// where there is none, that of most arrays. Dimensions of 1 do not count in an array of more than
/// two. Single numbers, and text, are left out, and so is what has not n rows or is no array of
/// real numbers, which a note names.
class MatRows final : public RowSource {
 public:
  /// @throws std::runtime_error naming the path and what is wrong: unreadable, damaged, no array
  /// that could be columns, vectors t of several lengths, a column that is there twice; or that
  /// libmatio was missing at build, or is missing now
  explicit MatRows(const std::string& path);

  const std::vector<std::string>& columns() const override { return columns_; }
  bool next(std::vector<double>& row, SkippedRows& skipped) override;
  long number() const override { return static_cast<long>(row_); }
  std::string_view unit() const override { return "row"; }

 private:
  std::vector<std::string> columns_;
  std::string note_;
  std::vector<double> numbers_;  // row by row
  std::size_t row_ = 0;
};

}  // namespace tauext
