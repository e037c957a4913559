// SPDX-License-Identifier: Apache-2.0
#include "regression/memory/committed.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <regex>
#include <set>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "mjcf/trace/input_file.h"
#include "regression/accuracy/accuracy.h"
#include "regression/accuracy/accuracy_layer.h"
#include "regression/counts/counts.h"

namespace tauext::gate {
namespace {

namespace fs = std::filesystem;

bool same_bits(const std::vector<double>& a, const std::vector<double>& b) {
  const auto same = [](double x, double y) {
    return std::bit_cast<std::uint64_t>(x) == std::bit_cast<std::uint64_t>(y);
  };
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), same);
}

std::string name_of_file(const std::string& path) {
  return fs::path(path).filename().string();
}

// a baseline of base's; nothing where this version cannot read it
template <class Read>
auto readable(const Read& read) -> std::optional<decltype(read())> {
  try {
    return read();
  } catch (const std::runtime_error&) {
    return std::nullopt;
  }
}

void compare_golden(const std::string& before_path, const std::string& path, MemoryReport& r) {
  const std::string file = name_of_file(path);
  const bool before = fs::exists(before_path), now = fs::exists(path);
  if (!before && !now) return;
  if (!now) return r.moved.push_back({file, "gone", true});
  const Golden head = read_golden(path);
  r.lines += static_cast<int>(head.lines.size());
  if (!before) return r.moved.push_back({file, "new", false});
  const auto base = readable([&] { return read_golden(before_path); });
  if (!base) return r.moved.push_back({file, "another format than base's", false});
  const AccuracyReport report = compare_accuracy(*base, head);
  if (!report.no_baseline.empty()) {
    r.moved.push_back({file, "cannot be compared with base's: " + report.no_baseline, true});
  }
  std::set<std::pair<std::string, std::string>> listed;
  for (const MetricChange& c : report.changes) {
    listed.emplace(c.entry, c.metric);
    r.moved.push_back(
        {fmt::format("{} {} {}", file, c.entry, c.metric),
         fmt::format("{} -> {}{}", c.change == Change::kNew ? "nothing" : said(c.before),
                     c.change == Change::kGone ? "gone" : said(c.after),
                     c.note.empty() ? "" : " (" + c.note + ")"),
         c.change == Change::kWorse || c.change == Change::kGone});
  }
  for (const auto& [key, line] : head.lines) {
    const auto was = base->lines.find(key);
    if (was == base->lines.end() || listed.contains(key)) continue;
    if (same_bits(was->second.values, line.values)) continue;
    r.moved.push_back(
        {fmt::format("{} {} {}", file, key.first, key.second), "within the tolerance", false});
  }
}

void compare_counts_of(const std::string& before_path, const std::string& path, MemoryReport& r) {
  const std::string file = name_of_file(path);
  const Counts head = read_counts(path);
  r.lines += static_cast<int>(head.kernels.size());
  if (!fs::exists(before_path)) return r.moved.push_back({file, "new", false});
  const auto base = readable([&] { return read_counts(before_path); });
  if (!base || base->key != head.key) {
    return r.moved.push_back({file, "another key or format than base's", true});
  }
  for (const CountChange& c : compare_counts(*base, head)) {
    r.moved.push_back({file + " " + c.kernel,
                       fmt::format("{} -> {} ({:+.2f} %)", c.before, c.after, 100 * c.change()),
                       too_many(c)});
  }
  for (const auto& [kernel, count] : base->kernels) {
    if (!head.kernels.contains(kernel)) r.moved.push_back({file + " " + kernel, "gone", true});
  }
  for (const auto& [kernel, count] : head.kernels) {
    if (!base->kernels.contains(kernel)) r.moved.push_back({file + " " + kernel, "new", false});
  }
}

std::vector<std::string> count_files(const std::string& folder) {
  std::vector<std::string> names;
  std::error_code missing;
  for (const auto& entry : fs::directory_iterator(folder, missing)) {
    const std::string name = entry.path().filename().string();
    if (name.starts_with("instructions-")) names.push_back(name);
  }
  std::sort(names.begin(), names.end());
  return names;
}

std::vector<std::string> reasons_of(const std::string& changelog) {
  std::vector<std::string> reasons;
  if (!fs::exists(changelog)) return reasons;
  std::istringstream in(read_whole(changelog));
  for (std::string line; std::getline(in, line);) {
    if (line.starts_with("- ")) reasons.push_back(line.substr(2));
  }
  return reasons;
}

// of a line of tauext-gate update: "less noise (3 worse, accepted: noise matters)"
int lines_accepted(const std::string& reason) {
  std::smatch found;
  static const std::regex kAccepted(R"(\((\d{1,6}) worse, accepted: )");
  return std::regex_search(reason, found, kAccepted) ? std::stoi(found[1]) : 0;
}

}  // namespace

int MemoryReport::worse() const {
  return static_cast<int>(
      std::count_if(moved.begin(), moved.end(), [](const Moved& m) { return m.worse; }));
}

MemoryReport compare_committed(const Committed& base, const Committed& head) {
  MemoryReport r;
  compare_golden(golden_path(base.baselines), golden_path(head.baselines), r);
  const std::vector<std::string> now = count_files(head.baselines);
  for (const std::string& file : now) {
    compare_counts_of(base.baselines + "/" + file, head.baselines + "/" + file, r);
  }
  for (const std::string& file : count_files(base.baselines)) {
    if (std::find(now.begin(), now.end(), file) == now.end()) {
      r.moved.push_back({file, "gone", false});  // of a compiler that nobody uses any more
    }
  }
  std::stable_sort(r.moved.begin(), r.moved.end(),
                   [](const Moved& a, const Moved& b) { return a.worse && !b.worse; });
  std::vector<std::string> before = reasons_of(base.changelog);
  for (std::string& reason : reasons_of(head.changelog)) {
    const auto known = std::find(before.begin(), before.end(), reason);
    if (known != before.end()) {
      before.erase(known);
      continue;
    }
    r.accepted += lines_accepted(reason);
    r.reasons.push_back(std::move(reason));
  }
  return r;
}

}  // namespace tauext::gate
