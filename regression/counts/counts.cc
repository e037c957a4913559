// SPDX-License-Identifier: Apache-2.0
#include "regression/counts/counts.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "mjcf/trace/input_file.h"
#include "mjcf/trace/text.h"

namespace tauext::gate {
namespace {

constexpr const char* kHeader = "# tauext instruction counts 1";
constexpr const char* kEnd = "# end";

constexpr std::size_t kGainsShown = 3;

// the functions that execute most more than before, the most first
std::vector<std::string> gains(const std::map<std::string, std::uint64_t>& was,
                               const std::map<std::string, std::uint64_t>& is) {
  std::vector<std::pair<std::int64_t, std::string>> all;
  for (const auto& [function, n] : is) {
    const auto f = was.find(function);
    const auto gain = static_cast<std::int64_t>(n - (f == was.end() ? 0 : f->second));
    if (gain > 0) all.emplace_back(gain, function);
  }
  std::sort(all.rbegin(), all.rend());
  std::vector<std::string> texts;
  for (std::size_t i = 0; i < std::min(all.size(), kGainsShown); ++i) {
    texts.push_back(
        fmt::format("{:+.1f} a step in {:.100}", a_step(all[i].first), short_name(all[i].second)));
  }
  return texts;
}

// the lines that changed most, both ways, as a sum would else not be theirs
std::vector<std::string> gains(const LineCounts& was, const LineCounts& is) {
  std::vector<std::string> texts;
  for (const LineChange& c : changed_lines(was, is)) {
    if (texts.size() == kGainsShown) break;
    texts.push_back(fmt::format("{:+.1f} a step at {}:{}", a_step(c.by), c.file, c.line));
  }
  return texts;
}

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

// a line of the key, of the columns' names or of a kernel
void read_line(const std::string& line, const std::string& path, Counts& counts) {
  const auto tab = line.find('\t'), colon = line.find(": ");
  if (line.starts_with("# ") && colon != std::string::npos) {
    counts.key[line.substr(2, colon - 2)] = line.substr(colon + 2);
    return;
  }
  if (line.starts_with("kernel\t")) return;
  if (tab == std::string::npos || tab == 0) {
    throw std::runtime_error(fmt::format("{}: '{}' is no line of counts", path, line));
  }
  const std::string kernel = line.substr(0, tab);
  if (!counts.kernels.emplace(kernel, whole_count(line.substr(tab + 1), path)).second) {
    throw std::runtime_error(fmt::format("{}: {} is there twice", path, kernel));
  }
}

}  // namespace

double a_step(std::int64_t instructions) {
  return static_cast<double>(instructions) / kCountedSteps;
}

std::uint64_t whole_count(const std::string& text, const std::string& path) {
  if (const auto value = number_in<std::uint64_t>(text)) return *value;
  throw std::runtime_error(fmt::format("{}: '{}' is no count", path, text));
}

std::string counts_path(const std::string& folder, const Key& key) {
  std::uint32_t hash = 2166136261u;  // FNV-1a
  for (const auto& [name, value] : key) {
    for (const char c : fmt::format("{}={}\n", name, value)) {
      hash = (hash ^ static_cast<unsigned char>(c)) * 16777619u;
    }
  }
  return fmt::format("{}/instructions-{:08x}.tsv", folder, hash);
}

std::string format_counts(const Counts& counts) {
  std::string text = fmt::format("{}\n", kHeader);
  for (const auto& [name, value] : counts.key) text += fmt::format("# {}: {}\n", name, value);
  text += fmt::format("kernel\tinstructions of {} steps\n", kCountedSteps);
  for (const auto& [kernel, count] : counts.kernels) text += fmt::format("{}\t{}\n", kernel, count);
  return text + kEnd + "\n";
}

Counts read_counts(const std::string& path) {
  std::istringstream in(read_whole(path));
  Counts counts;
  std::string line;
  if (!std::getline(in, line) || line != kHeader) {
    throw std::runtime_error(
        fmt::format("{}: no instruction counts: it must begin with '{}'", path, kHeader));
  }
  bool end = false;
  while (!end && std::getline(in, line)) {
    if (line == kEnd) {
      end = true;
    } else {
      read_line(line, path, counts);
    }
  }
  if (!end)
    throw std::runtime_error(fmt::format("{}: cut off, its last line is not '{}'", path, kEnd));
  if (counts.kernels.empty()) throw std::runtime_error(path + ": holds no count");
  return counts;
}

std::optional<Counts> committed_counts(const std::string& folder, const Key& key) {
  const std::string path = counts_path(folder, key);
  if (!std::filesystem::exists(path)) return std::nullopt;
  Counts counts = read_counts(path);
  if (counts.key != key) {
    throw std::runtime_error(path + ": its key is not the one that its name was made from");
  }
  return counts;
}

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

std::vector<CountChange> compare_counts(const Counts& before, const Counts& after) {
  if (before.key != after.key) {
    throw std::invalid_argument("counts of different keys: " +
                                key_difference(before.key, after.key));
  }
  std::vector<CountChange> changes;
  for (const auto& [kernel, count] : after.kernels) {
    const auto old = before.kernels.find(kernel);
    if (old == before.kernels.end() || old->second == count) continue;
    CountChange c{.kernel = kernel, .before = old->second, .after = count};
    const auto take = [&c](const auto& of_before, const auto& of_after) {
      const auto was = of_before.find(c.kernel), is = of_after.find(c.kernel);
      if (!c.gained.empty() || was == of_before.end() || is == of_after.end()) return;
      c.gained = gains(was->second, is->second);
    };
    take(before.lines, after.lines);
    take(before.functions, after.functions);
    changes.push_back(std::move(c));
  }
  return changes;
}

std::set<std::string> counted_otherwise(const Counts& before, const Counts& after) {
  std::set<std::string> names;
  for (const auto& [kernel, count] : after.kernels) {
    const auto old = before.kernels.find(kernel);
    if (old != before.kernels.end() && old->second != count) names.insert(kernel);
  }
  return names;
}

bool too_many(const CountChange& c) {
  return c.accepted.empty() && c.change() > kCountLimit;
}

std::string short_name(const std::string& name) {
  std::string out;
  int depth = 0;
  for (const char c : name) {
    if (c == '<' || c == '(') ++depth;
    if (depth == 0) out += c;
    if ((c == '>' || c == ')') && depth > 0) --depth;
  }
  return out;
}

std::string key_difference(const Key& there, const Key& here) {
  std::vector<std::string> parts;
  Key all = there;
  all.insert(here.begin(), here.end());
  const auto value = [](const Key& k, const std::string& name) {
    const auto it = k.find(name);
    return it == k.end() ? std::string("none") : it->second;
  };
  for (const auto& [name, ignored] : all) {
    if (value(there, name) == value(here, name)) continue;
    parts.push_back(
        fmt::format("{}: '{}' there, '{}' here", name, value(there, name), value(here, name)));
  }
  return fmt::format("{}", fmt::join(parts, "; "));
}

}  // namespace tauext::gate
