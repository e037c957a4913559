// SPDX-License-Identifier: Apache-2.0
/// @file
/// The rows of one NumPy array.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "mjcf/trace/read/numpy/byte_stream.h"
#include "mjcf/trace/read/numpy/npy_header.h"

namespace tauext {

/// How many streams an array, or a .npz, may need.
inline constexpr std::size_t kMostNpyLanes = 256;

/// Reads an array of 1 or 2 dimensions row by row: from one stream, or where it is in Fortran order
/// from as many as it has columns.
class ArrayReader {
 public:
  /// The file must outlive it.
  /// @param name of the array in a .npz; "" of a .npy
  /// @throws std::runtime_error naming path and array, if it holds no rows of numbers, or not as
  /// many bytes as its header says
  ArrayReader(const ByteFile& file, const Extent& extent, const NpyHeader& header,
              const std::string& name);

  std::uint64_t rows() const { return rows_; }
  /// How many streams it reads, each of which has some 70 kB where the array is compressed.
  std::size_t lanes() const { return lanes_.size(); }
  const std::string& name() const { return name_; }
  const std::vector<std::string>& columns() const { return columns_; }
  /// The next row, of which there are rows(); a number for each column.
  /// @throws std::runtime_error naming path and array, if it is damaged
  void next(double* row);

 private:
  struct Cell {
    NpyNumber number;
    std::size_t offset;  // [bytes]
  };
  struct Lane {  // a stream with what is taken of it for each row
    ByteStream stream;
    std::vector<Cell> cells;
    std::size_t row_size;  // [bytes]
  };

  void name_columns(const NpyHeader& header);
  void check_size(const Extent& extent, const NpyHeader& header, std::size_t row_size) const;
  void add_lane(const ByteFile& file, const Extent& extent, std::uint64_t at, bool checked,
                std::size_t row_size, std::vector<Cell> cells);

  std::string name_;
  std::uint64_t rows_ = 0;
  std::vector<std::string> columns_;
  std::vector<Lane> lanes_;
  std::vector<unsigned char> bytes_;  // of a row
};

/// Whether an array of a .npz is none of its columns: a number without a dimension, or text.
bool is_metadata(const NpyHeader& header);

}  // namespace tauext
