// SPDX-License-Identifier: Apache-2.0
/// @file
/// Several files that are one recording: parts that follow each other, or columns side by side.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "mjcf/trace/read/row_source.h"

namespace tauext {

/// Opens one of the files.
using OpenRows = std::function<std::unique_ptr<RowSource>(const std::string& path)>;

/// Between the name of a file and that of its column, in those of side_by_side().
inline constexpr char kOfFile[] = ": ";

/// The rows of the files in a folder whose whole names an expression matches, one file after the
/// other: in the order of the numbers in the expression's first group, and else of their names. All
/// have the columns of the first. If each begins with the last row of the one before, that comes
/// once, and a note says so.
/// @throws std::runtime_error naming the path: no folder, none that matches, two of one number; and
/// of next(), too, a part with other columns
std::unique_ptr<RowSource> parts_in(const std::string& folder, const std::string& expression,
                                    const OpenRows& open);

/// Row i of each file, side by side. Columns are called as in the first file, or `FILE: COLUMN`.
/// A row that cannot be read in one of them is left out in all.
/// @param folder that has the files
/// @param first path of a further one; "": there is none
/// @throws std::runtime_error as RowSource, and naming a file that has fewer rows than another
std::unique_ptr<RowSource> side_by_side(const std::string& folder, const std::string& first,
                                        const std::vector<std::string>& files,
                                        const OpenRows& open);

}  // namespace tauext
