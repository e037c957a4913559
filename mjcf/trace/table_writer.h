// SPDX-License-Identifier: Apache-2.0
/// @file
/// The one writer of tables for people: aligned text, or the same for a spreadsheet, a page or a
/// paper.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace tauext {

/// How a table is written.
enum class TableFormat { kText, kCsv, kJson, kMarkdown, kLatex };

/// "text", "csv", "json", "md" or "latex".
/// @throws std::invalid_argument for another name, listing these
TableFormat table_format(std::string_view name);

/// Rows under columns with a title and a unit. Cells are text; numbers are formatted by who adds
/// them.
class TableWriter {
 public:
  /// What stands above a column, and how its cells stand.
  struct Column {
    std::string title;      ///< one or two words
    std::string unit = "";  ///< "" for none
    bool left = false;      ///< else aligned to the right, as numbers are
    std::size_t width =
        0;  ///< characters at least, so that a screen that is refreshed stands still
  };
  /// A table without rows.
  explicit TableWriter(std::vector<Column> columns) : columns_(std::move(columns)) {}

  /// A mark (`*`, ..) at the end of a cell stands beside the column, so that digits stay aligned.
  static constexpr char kMark = '*';

  /// @throws std::logic_error for another number of cells than columns
  void add(std::vector<std::string> cells);
  /// A line across the columns, in place of a row; in text alone, as the other formats have rows
  /// only.
  void add_note(const std::string& text);
  /// An empty line between groups of rows; in text alone.
  void add_gap();

  bool empty() const { return rows_.empty(); }  ///< whether it has no rows

  /// Ends with a line end. JSON: an array of objects, `title_unit` to the cell, as a number where
  /// it is one, null for "-", "never" and an empty cell.
  std::string format(TableFormat format = TableFormat::kText) const;

 private:
  struct Row {
    std::vector<std::string> cells;  // none: a gap or a note
    std::string note;
  };
  std::string text() const;
  std::string csv() const;
  std::string json() const;
  std::string markdown() const;
  std::string latex() const;

  std::vector<Column> columns_;
  std::vector<Row> rows_;
};

}  // namespace tauext
