// SPDX-License-Identifier: Apache-2.0
/// @file
/// Table III of the paper beside what the suite measures.
#pragma once

#include <array>
#include <string>
#include <vector>

namespace tauext::study {

/// A row of Table III or of its counterpart: one time per joint 2, 3, 4.
struct Table3Row {
  std::string quantity;        ///< "rise" or "settling", and how it is defined
  std::array<double, 3> ekf;   ///< [s]
  std::array<double, 3> ndob;  ///< [s]
};

/// The two rows as printed.
std::vector<Table3Row> table3_printed();

/// The step scenario with a panel [kg]: rise 10-90 %, rise 0-90 %, settling to 2 %.
std::vector<Table3Row> table3_measured(double panel);

/// Both, and why they cannot agree.
std::string format_table3();

}  // namespace tauext::study
