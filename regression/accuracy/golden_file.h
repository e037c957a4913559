// SPDX-License-Identifier: Apache-2.0
/// @file
/// Reads golden metrics; bench/seeds/golden.h writes them and says what they are.
#pragma once

#include <limits>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace tauext::gate {

/// The value of what never happened.
inline constexpr double kNever = std::numeric_limits<double>::quiet_NaN();

/// One line: a metric of an entry, seed by seed.
struct GoldenLine {
  std::vector<double> values;  ///< a seed each
};

/// A file of golden metrics.
struct Golden {
  std::map<std::string, std::string> header;  ///< mujoco, sensors, contacts, built
  std::vector<std::string> seeds;
  std::map<std::pair<std::string, std::string>, GoldenLine> lines;  ///< by entry and metric
};

/// @param path to be named in errors
/// @throws std::runtime_error naming the path and the line: cut off, foreign, a value that is no
/// number
Golden parse_golden(const std::string& text, const std::string& path);

/// @throws std::runtime_error as parse_golden does, and for an unreadable file
Golden read_golden(const std::string& path);

}  // namespace tauext::gate
