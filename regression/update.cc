// SPDX-License-Identifier: Apache-2.0
#include "regression/update.h"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <filesystem>
#include <iterator>
#include <memory>
#include <regex>
#include <set>
#include <sstream>
#include <stdexcept>
#include <utility>
#include <vector>

#include "bench/score/metric_list.h"
#include "mjcf/trace/atomic_file.h"
#include "mjcf/trace/input_file.h"
#include "regression/accuracy/accuracy_layer.h"
#include "regression/counts/instructions.h"

namespace tauext::gate {
namespace {

namespace fs = std::filesystem;

void require_one_line(const std::string& what, const std::string& text) {
  if (text.find_first_not_of(" \t") == std::string::npos) {
    throw std::invalid_argument(fmt::format("--{}: say why; it goes into the changelog", what));
  }
  if (text.find_first_of("\r\n") != std::string::npos) {
    throw std::invalid_argument(fmt::format("--{}: one line", what));
  }
}

// files that are all written before the first one appears
class Files {
 public:
  void add(const std::string& path, const std::string& text) {
    if (fs::exists(path) && read_whole(path) == text) return;
    release_input(path);  // it is made of what it was
    files_.push_back(std::make_unique<AtomicFile>(path));
    files_.back()->write(text);
    names_.push_back(path);
  }
  void commit() {
    for (auto& f : files_) f->commit();
  }
  const std::vector<std::string>& names() const { return names_; }

 private:
  std::vector<std::unique_ptr<AtomicFile>> files_;
  std::vector<std::string> names_;
};

// one line for each number that is not as it was
struct Changes {
  std::string worse, other;
};

Changes update_counts(const UpdateOptions& o, Files& files) {
  Changes changes;
  Counts head = count_instructions(o.head, o.kernels);
  if (const std::optional<Counts> before = committed_counts(o.baselines, head.key)) {
    for (const CountChange& c : compare_counts(*before, head)) {
      const std::string line =
          fmt::format("  {}: {:+.2f} % instructions\n", c.kernel, 100 * c.change());
      (too_many(c) ? changes.worse : changes.other) += line;
    }
    const std::regex wanted(o.kernels);
    for (const auto& [kernel, count] : before->kernels) {
      if (!std::regex_search(kernel, wanted)) {
        head.kernels[kernel] = count;
      } else if (!head.kernels.contains(kernel)) {
        changes.worse += "  " + kernel + ": gone\n";
      }
    }
  }
  files.add(counts_path(o.baselines, head.key), format_counts(head));
  return changes;
}

// the new text, with the old lines of entries that do not match, and the contacts of both
std::string merged(const std::string& before, const std::string& now, const std::string& entries) {
  const std::regex wanted(entries);
  const auto is_metric = [](const std::string& line) {
    return !line.starts_with("#") && !line.starts_with("entry\t");
  };
  std::set<std::string> lines, contacts;
  const auto met = [&contacts](const std::string& line) {
    constexpr std::string_view kContacts = "# contacts:";
    if (!line.starts_with(kContacts)) return false;
    std::istringstream words(line.substr(kContacts.size()));
    contacts.insert(std::istream_iterator<std::string>(words), {});
    return true;
  };
  std::istringstream old_lines(before), new_lines(now);
  for (std::string line; std::getline(old_lines, line);) {
    if (met(line) || !is_metric(line)) continue;
    if (!std::regex_search(line.substr(0, line.find('\t')), wanted)) lines.insert(line);
  }
  std::string head;
  for (std::string line; std::getline(new_lines, line);) {
    if (is_metric(line)) {
      lines.insert(line);
    } else if (met(line)) {
      head += fmt::format("# contacts: {}\n", fmt::join(contacts, " "));
    } else if (line != "# end") {
      head += line + "\n";
    }
  }
  for (const std::string& line : lines) head += line + "\n";
  return head + "# end\n";
}

Changes update_golden(const UpdateOptions& o, Files& files) {
  Changes changes;
  const std::string path = golden_path(o.baselines);
  std::string text = run_bench(o.bench, o.entries);
  const Golden head = parse_golden(text, "what " + o.bench + " wrote");
  if (fs::exists(path)) {
    const AccuracyReport r = compare_accuracy(read_golden(path), head, o.entries);
    if (!r.no_baseline.empty() && !o.entries.empty()) {
      throw std::invalid_argument(
          fmt::format("{}: {}; update it without --entries", path, r.no_baseline));
    }
    if (!r.no_baseline.empty()) changes.worse += "  cannot be compared: " + r.no_baseline + "\n";
    for (const MetricChange& c : r.changes) {
      const std::string line =
          fmt::format("  {} {}: {} -> {}{}\n", c.entry, c.metric, said(c.before),
                      c.change == Change::kGone ? "gone" : said(c.after),
                      c.note.empty() ? "" : " (" + c.note + ")");
      const bool failed =
          c.change == Change::kNew && c.metric == row_of(Metric::kFailed).key && c.after > 0;
      const bool bad = failed || c.change == Change::kWorse || c.change == Change::kGone;
      (bad ? changes.worse : changes.other) += line;
    }
    if (!o.entries.empty()) text = merged(read_whole(path), text, o.entries);
  }
  if (!fs::exists(path)) {
    for (const auto& [key, line] : head.lines) {
      if (key.second == row_of(Metric::kFailed).key &&
          line.values != std::vector<double>(line.values.size(), 0)) {
        changes.worse += "  " + key.first + ": fails\n";
      }
    }
  }
  files.add(path, text);
  return changes;
}

std::string first_lines(const std::string& text, int most) {
  std::size_t at = 0;
  for (int i = 0; i < most && at != std::string::npos; ++i) at = text.find('\n', at + (i > 0));
  if (at == std::string::npos || at + 1 >= text.size()) return text;
  const auto rest =
      std::count(text.begin() + static_cast<std::ptrdiff_t>(at) + 1, text.end(), '\n');
  return text.substr(0, at + 1) + fmt::format("  ... and {} more\n", rest);
}

}  // namespace

UpdateResult update_baselines(const UpdateOptions& o) {
  require_one_line("reason", o.reason);
  if (!o.accept_worse.empty()) require_one_line("accept-worse", o.accept_worse);
  if (o.head.empty() && o.bench.empty())
    throw std::invalid_argument("nothing to update: no --head, no --bench");
  fs::create_directories(o.baselines);
  std::string log =
      fs::exists(o.changelog) ? read_whole(o.changelog) : "# Baselines\nEach line moved them.\n\n";
  Files files;
  const Changes counts = o.head.empty() ? Changes() : update_counts(o, files);
  const Changes metrics = o.bench.empty() ? Changes() : update_golden(o, files);
  const std::string worse = counts.worse + metrics.worse;
  if (!worse.empty() && o.accept_worse.empty()) {
    return {counts.worse.empty() ? kLessAccurate : kSlower,
            "refused: these would be worse, or cannot be compared:\n" + first_lines(worse, 20) +
                "If that is right: --accept-worse 'the reason'\n"};
  }
  if (files.names().empty())
    return {kGood, "the baselines are as they should be; nothing was written\n"};
  UpdateResult result;
  for (const std::string& name : files.names()) result.text += "wrote " + name + "\n";
  log += fmt::format(
      "- {:%Y-%m-%d}: {}{}\n", fmt::gmtime(std::time(nullptr)), o.reason,
      worse.empty() ? ""
                    : fmt::format(" ({} worse, accepted: {})",
                                  std::count(worse.begin(), worse.end(), '\n'), o.accept_worse));
  files.add(o.changelog, log);
  files.commit();
  result.text += first_lines(worse + counts.other + metrics.other, 20) + "The reason is in " +
                 o.changelog + "\n";
  return result;
}

}  // namespace tauext::gate
