// SPDX-License-Identifier: Apache-2.0
/// @file
/// Recordings as NumPy saves them: .npy, .npz.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "mjcf/trace/read/row_source.h"

namespace tauext {

class ByteFile;
class ArrayReader;

/// The rows of a .npy or a .npz, whatever its name is. Any plain numbers are read, of either byte
/// order, in C or in Fortran order.
///
/// The columns of a .npy are "1", "2", .. or, of a structured array, have the names of its fields;
/// ('q', '<f8', (6,)) is q1 .. q6. Those of a .npz are its arrays side by side: t of shape (n,) is
/// the column t, q of shape (n, k) is q1 .. qk, and a structured one is its fields. Arrays without
/// a dimension, and arrays of text, are left out.
class NpyRows : public RowSource {
 public:
  /// @throws std::runtime_error naming the path, the array and what is wrong: unreadable, neither a
  /// .npy nor a .npz, cut off, Python objects, arrays that are not as long as t (or the first one,
  /// where none is named t), a column that is there twice; or that zlib, which a .npz needs, was
  /// missing at build
  explicit NpyRows(const std::string& path);
  ~NpyRows() override;

  const std::vector<std::string>& columns() const override { return columns_; }
  /// @throws std::runtime_error naming path and array, also if its checksum is another one
  bool next(std::vector<double>& row, SkippedRows& skipped) override;
  long number() const override { return static_cast<long>(row_); }

 private:
  void add_members();
  void refuse_other_lengths();
  void take_columns();

  std::unique_ptr<ByteFile> file_;
  std::vector<std::unique_ptr<ArrayReader>> arrays_;
  std::vector<std::string> columns_;
  std::uint64_t rows_ = 0, row_ = 0;
};

}  // namespace tauext
