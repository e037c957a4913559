// SPDX-License-Identifier: Apache-2.0
/// @file
/// Writes what numpy.load reads.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "mjcf/trace/trace.h"

namespace tauext {

/// Numbers to be written, row after row as they lie in memory: those of a column-major
/// Eigen::MatrixXd are its columns one after the other.
struct NpyArray {
  std::string name;         ///< in a .npz
  const double* data;       ///< rows * columns of them; rows, if it has 1 dimension
  std::size_t rows = 0;     ///< of them
  std::size_t columns = 0;  ///< 0: an array of 1 dimension, of shape (rows,)
};

/// Writes a .npz, not compressed, to standard output if the path is "-". The file appears whole or
/// not at all.
/// @throws std::runtime_error naming the path, also if it had more than 4 GiB or 65535 arrays, or
/// if zlib was missing at build
void write_npz(const std::string& path, const std::vector<NpyArray>& arrays);

/// A trace as a .npz: the arrays t, q, qd, tau (tau_instant, if it was read at instants), and
/// tau_ext and contact where they are known.
/// @throws as write_npz
void write_npz(const std::string& path, const Trace& trace);

}  // namespace tauext
