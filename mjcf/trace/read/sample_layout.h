// SPDX-License-Identifier: Apache-2.0
/// @file
/// The quantities of a sample side by side, as they are taken from the rows of a recording.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "mjcf/trace/read/column_map.h"

namespace tauext {

/// Where they are, in SI units; t is the first.
struct SampleLayout {
  int dof = 0;  ///< joints
  /// where each begins; -1: the recording does not have it
  int q = -1, qd = -1, tau = -1, tau_ext = -1, driver = -1, force = -1, contact = -1;
  int size = 1;                           ///< numbers
  bool instants = false;                  ///< tau was read at t
  bool currents = false;                  ///< tau is in A: of drives whose gains are not known
  bool without_gravity = false;           ///< Trace::tau_without_gravity
  std::vector<std::pair<int, double>> t;  ///< columns and gains, which are added up; may be none
  /// What makes another number of a row.
  struct Number {
    int column;
    double gain;  ///< to SI units
    double zero;  ///< [SI] that is added then
  };
  std::vector<Number> rest;        ///< all others
  std::vector<std::string> names;  ///< of all, like "[q] of joint 2"; the first is that of t

  std::vector<int> columns() const;  ///< that matter
  /// The sample of a row [SI], without a time of columns 0.
  void convert(const std::vector<double>& row, std::vector<double>& sample) const;
};

/// @param has_t whether there must be a time
/// @throws std::runtime_error naming the path and what is missing, or does not fit
SampleLayout layout_of(const MappedColumns& mapped, const std::vector<std::string>& columns,
                       const std::string& path, bool has_t = true);

}  // namespace tauext
