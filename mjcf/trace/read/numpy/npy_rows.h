// SPDX-License-Identifier: Apache-2.0
/// @file
/// Recordings as NumPy saves them: .npy, .npz.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "mjcf/trace/read/numpy/npy_header.h"
#include "mjcf/trace/read/row_source.h"

namespace tauext {

/// The rows of a .npy or a .npz, whatever its name is, which is read as a whole. Any plain numbers
/// are read, of either byte order, in C or in Fortran order.
///
/// The columns of a .npy are "1", "2", .. or, of a structured array, have the names of its fields;
/// ('q', '<f8', (6,)) is q1 .. q6. Those of a .npz are its arrays side by side: t of shape (n,) is
/// the column t, q of shape (n, k) is q1 .. qk, and a structured one is its fields. Arrays without
/// a dimension, and arrays of text, are left out.
class NpyRows : public RowSource {
 public:
  /// @throws std::runtime_error naming the path, the array and what is wrong: unreadable, neither a
  /// .npy nor a .npz, cut off or damaged, more than 2 GiB unpacked, Python objects, arrays that are
  /// not as long as t (or the first one, where none is named t), a column that is there twice; or
  /// that libarchive, which a .npz needs, was missing at build
  explicit NpyRows(const std::string& path);

  const std::vector<std::string>& columns() const override { return columns_; }
  bool next(std::vector<double>& row, SkippedRows& skipped) override;
  long number() const override { return static_cast<long>(row_); }
  std::string_view unit() const override { return "row"; }

 private:
  struct Cell {
    NpyNumber number;
    std::size_t at;      // [bytes] where that of the first row is
    std::size_t stride;  // [bytes] to that of the next row
  };
  struct Array {
    std::string name, bytes;
    std::size_t rows = 0;
    std::vector<Cell> cells;
  };

  void add(const std::string& what, std::string name, std::string bytes);
  void require_equal_lengths(const std::string& path);
  void require_different_columns(const std::string& path) const;

  std::vector<Array> arrays_;
  std::vector<std::string> columns_;
  std::size_t rows_ = 0, row_ = 0;
};

}  // namespace tauext
