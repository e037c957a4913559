// SPDX-License-Identifier: Apache-2.0
/// @file
/// Text of numbers: a line for each row, the columns apart by commas or whatever it is.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "mjcf/trace/read/row_source.h"
#include "mjcf/trace/read/text/unpacked_file.h"

namespace tauext {

/// How such a text is written.
struct CsvFormat {
  char separator = 0;  ///< ' ': any number of blanks; 0: the comma, semicolon or tabulator of the
                       ///< first line, or else blanks
  bool has_header = true;  ///< else the columns are called 1, 2, ..
  bool finite = true;      ///< a row with NaN or infinity cannot be read
  bool holes = false;      ///< a field may be empty, or say that it is (NA, null), and is NaN then
};

/// The rows of such a file, which may be compressed. Lines may end in CR and LF, and have up to
/// 64 kB; empty ones, and those that begin with # or %, are no rows. The names are in the first
/// line that is no comment, or in the last comment above the numbers; Excel's sep=; may stand
/// before. A column of a name that an earlier one has gets `#2` behind it.
class CsvRows final : public RowSource {
 public:
  /// @throws std::runtime_error naming the path and the reason: unreadable, empty, no names
  CsvRows(const std::string& path, const CsvFormat& format);

  const std::vector<std::string>& columns() const override { return columns_; }
  void read_only(const std::vector<int>& wanted) override;
  void look_at(const std::vector<int>& columns) override;
  bool next(std::vector<double>& row, SkippedRows& skipped) override;
  long number() const override { return number_; }
  std::string_view unit() const override { return "line"; }

 private:
  bool next_line(std::string_view& line);
  bool refill();
  std::string_view first_line();
  void unread(std::string_view line);
  void read_header();
  std::string parse(std::string_view line, std::vector<double>& row, SkippedRows& skipped) const;
  bool take_field(std::string_view& rest, std::string_view& field) const;

  std::string path_;
  CsvFormat format_;
  UnpackedFile file_;
  std::vector<char> buffer_;
  std::size_t begin_ = 0, end_ = 0;        // of what is left in it
  bool at_end_ = false, cut_off_ = false;  // of the file; the last line has no end
  long number_ = 0;
  std::vector<std::string> columns_;
  enum class Use { kNone, kIfNumber, kNumber };
  std::vector<Use> wanted_;  // of each column
};

}  // namespace tauext
