// SPDX-License-Identifier: Apache-2.0
#include "regression/counts/lines.h"

#include <algorithm>
#include <cstdlib>
#include <set>

namespace tauext::gate {
namespace {

struct Line {
  int number;
  std::uint64_t count;
};

std::vector<Line> lines_of_file(const LineCounts& counts, const std::string& file) {
  std::vector<Line> lines;
  for (auto it = counts.lower_bound({file, 0}); it != counts.end() && it->first.first == file;
       ++it) {
    lines.push_back({it->first.second, it->second});
  }
  return lines;
}

// [i][j]: how many lines of a from i and of b from j on can be paired
std::vector<std::vector<int>> pairs_left(const std::vector<Line>& a, const std::vector<Line>& b) {
  std::vector<std::vector<int>> left(a.size() + 1, std::vector<int>(b.size() + 1));
  for (std::size_t i = a.size(); i-- > 0;) {
    for (std::size_t j = b.size(); j-- > 0;) {
      left[i][j] = a[i].count == b[j].count ? left[i + 1][j + 1] + 1
                                            : std::max(left[i + 1][j], left[i][j + 1]);
    }
  }
  return left;
}

void compare_file(const std::string& file, const std::vector<Line>& a, const std::vector<Line>& b,
                  std::vector<LineChange>& changes) {
  const std::vector<std::vector<int>> left = pairs_left(a, b);
  LineChange open{.file = file};
  const auto close = [&] {
    if (open.by != 0) changes.push_back(open);
    open = {.file = file};
  };
  std::size_t i = 0, j = 0;
  while (i < a.size() || j < b.size()) {
    if (i < a.size() && j < b.size() && a[i].count == b[j].count) {
      if (open.line == 0) open.line = b[j].number;
      close();
      ++i, ++j;
    } else if (j < b.size() && (i == a.size() || left[i][j + 1] >= left[i + 1][j])) {
      if (open.line == 0) open.line = b[j].number;
      open.by += static_cast<std::int64_t>(b[j++].count);
    } else {
      open.by -= static_cast<std::int64_t>(a[i++].count);
    }
  }
  if (open.line == 0 && !b.empty()) open.line = b.back().number;
  close();
}

}  // namespace

std::vector<LineChange> changed_lines(const LineCounts& before, const LineCounts& after) {
  std::set<std::string> files;
  for (const LineCounts* counts : {&before, &after}) {
    for (const auto& [place, count] : *counts) files.insert(place.first);
  }
  std::vector<LineChange> changes;
  for (const std::string& file : files) {
    compare_file(file, lines_of_file(before, file), lines_of_file(after, file), changes);
  }
  std::stable_sort(changes.begin(), changes.end(), [](const LineChange& a, const LineChange& b) {
    return std::abs(a.by) > std::abs(b.by);
  });
  return changes;
}

}  // namespace tauext::gate
