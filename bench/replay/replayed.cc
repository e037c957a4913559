// SPDX-License-Identifier: Apache-2.0
#include "bench/replay/replayed.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <list>
#include <utility>

#include "bench/score/detection_metrics.h"
#include "bench/score/metrics.h"
#include "mjcf/trace/atomic_file.h"
#include "mjcf/trace/read/npy_writer.h"
#include "mjcf/trace/table_writer.h"

namespace tauext {
namespace {

std::string marks_name(const Replayed& c, bool several) {
  return several ? fmt::format("{}_{}_mark", c.estimator, c.detector)
                 : fmt::format("{}_mark", c.detector);
}

std::string titles_of_forces(const std::string& estimator, int dof) {
  const bool moment = dof >= kJointsOfMoment;
  std::string all;
  const auto add = [&](std::initializer_list<const char*> names) {
    for (const char* n : names) all += fmt::format(",{}_{}", estimator, n);
  };
  add({"fx", "fy", "fz"});
  if (moment) add({"mx", "my", "mz"});
  add({"seen_fx", "seen_fy", "seen_fz"});
  if (moment) add({"seen_mx", "seen_my", "seen_mz"});
  add({"left_over", "link"});
  if (moment) add({"line_x", "line_y", "line_z", "line_dx", "line_dy", "line_dz"});
  return all;
}

void append_forces(const Acting& a, int dof, fmt::memory_buffer& out) {
  const auto to = std::back_inserter(out);
  const int components = dof >= kJointsOfMoment ? 6 : 3;
  const auto add = [&](const auto& v, int from, int n) {
    for (int i = from; i < from + n; ++i) fmt::format_to(to, ",{:.9g}", v[i]);
  };
  add(a.force.force, 0, 3);
  if (components == 6) add(a.force.moment, 0, 3);
  add(a.force.seen, 0, components);
  fmt::format_to(to, ",{:.9g},{}", a.force.left_over, a.touch.link + 1);
  if (components == 3) return;
  if (!a.touch.has_line) {
    fmt::format_to(to, ",,,,,,");
    return;
  }
  add(a.touch.line.point, 0, 3);
  add(a.touch.line.direction, 0, 3);
}

// the same as arrays of NumPy, a row for each sample
void write_arrays(const Trace& trace, const std::vector<Replayed>& all, const std::string& path) {
  const auto n = static_cast<std::size_t>(trace.size());
  std::list<std::vector<double>> kept;  // where the arrays lie
  std::vector<NpyArray> arrays = {{"t", trace.t.data(), n}};
  const auto add = [&](std::string name, std::size_t columns, auto&& of) {
    std::vector<double>& values = kept.emplace_back();
    for (std::size_t k = 0; k < n; ++k)
      for (std::size_t c = 0; c < std::max<std::size_t>(columns, 1); ++c)
        values.push_back(static_cast<double>(of(k, c)));
    arrays.push_back({std::move(name), values.data(), n, columns});
  };
  for (const Replayed& c : all) {
    const Output& o = c.output;
    arrays.push_back(
        {c.estimator + "_tau_ext", o.tau_ext.data(), n, static_cast<std::size_t>(trace.dof())});
    add(c.estimator + "_status", 0, [&](auto k, auto) { return static_cast<int>(o.status[k]); });
    if (!o.marks.empty())
      add(marks_name(c, all.size() > 1), 0, [&](auto k, auto) { return int{o.marks[k]}; });
    if (c.acting.empty()) continue;
    add(c.estimator + "_force", 3, [&](auto k, auto i) { return c.acting[k].force.force[i]; });
    if (trace.dof() >= kJointsOfMoment)
      add(c.estimator + "_moment", 3, [&](auto k, auto i) { return c.acting[k].force.moment[i]; });
    add(c.estimator + "_link", 0, [&](auto k, auto) { return c.acting[k].touch.link + 1; });
  }
  write_npz(path, arrays);
}

// with Wilson's interval
std::string shown_recall(const Score& s) {
  const double recall = *s.get(Metric::kRecall);
  const metrics::Interval i =
      metrics::share_interval(static_cast<int>(std::lround(recall * s.collisions)), s.collisions);
  return fmt::format("{:.3g} ({:.2f} to {:.2f} with 95 %)", recall, i.low, i.high);
}

// what a detector was worth; nothing where the log does not say what happened
std::string verdict(const Score& s) {
  const auto alarms = s.get(Metric::kFalseAlarms);
  if (!alarms) return "";
  const auto delay = s.get(Metric::kDelay);
  return fmt::format("{} false alarms, {}", *alarms,
                     !delay               ? "no collision in the log"
                     : std::isnan(*delay) ? "no collision detected"
                                          : fmt::format("recall {}, largest delay {:.3f} s",
                                                        shown_recall(s), *delay));
}

}  // namespace

std::vector<Acting> acting(const ArmForces& arm, const Trace& trace, const Output& output) {
  std::vector<Acting> all;
  for (int k = 0; k < trace.size(); ++k) {
    const Eigen::VectorXd q = trace.q.col(k), tau_ext = output.tau_ext.col(k);
    all.push_back({arm.at_site(q.data(), tau_ext.data()), arm.touch(q.data(), tau_ext.data())});
  }
  return all;
}

void write_estimates(const Trace& trace, const std::vector<Replayed>& all,
                     const std::string& path) {
  if (path.ends_with(".npz")) return write_arrays(trace, all, path);
  // with one estimator, <detector>_mark is unambiguous; with more, the estimator's name comes first
  const bool several = all.size() > 1;
  fmt::memory_buffer out;
  const auto to = std::back_inserter(out);
  fmt::format_to(to, "t");
  for (const Replayed& c : all) {
    for (int j = 1; j <= trace.dof(); ++j) fmt::format_to(to, ",{}_tau_ext{}", c.estimator, j);
    fmt::format_to(to, ",{}_status", c.estimator);
    if (!c.output.marks.empty()) fmt::format_to(to, ",{}", marks_name(c, several));
    if (!c.acting.empty()) fmt::format_to(to, "{}", titles_of_forces(c.estimator, trace.dof()));
  }
  fmt::format_to(to, "\n");
  for (int k = 0; k < trace.size(); ++k) {
    fmt::format_to(to, "{:.17g}", trace.t[k]);
    for (const Replayed& c : all) {
      for (int j = 0; j < trace.dof(); ++j) fmt::format_to(to, ",{:.17g}", c.output.tau_ext(j, k));
      fmt::format_to(to, ",{}", static_cast<int>(c.output.status[k]));
      if (!c.output.marks.empty()) fmt::format_to(to, ",{}", int{c.output.marks[k]});
      if (!c.acting.empty()) append_forces(c.acting[k], trace.dof(), out);
    }
    fmt::format_to(to, "\n");
  }
  AtomicFile file(path);  // not before all is ready: an interrupt leaves nothing behind
  file.write({out.data(), out.size()});
  file.commit();
}

void print_metrics(const Trace& trace, const std::vector<Replayed>& all, double score_from,
                   std::FILE* to) {
  constexpr Metric kShown[] = {Metric::kRmse, Metric::kBias, Metric::kMax};
  std::vector<TableWriter::Column> titles = {{.title = "estimator", .left = true},
                                             {.title = "joint"}};
  for (const Metric m : kShown) {
    titles.push_back({title_of(m), std::string(row_of(m).unit)});
  }
  TableWriter table(std::move(titles));
  std::string verdicts;  // without a truth they stand alone
  for (const Replayed& c : all) {
    Score s;
    if (trace.has_truth()) add_error_metrics(trace, c.output, score_from, s);
    add_detection_metrics(trace, c.output, s);
    for (int j = 0; trace.has_truth() && j < trace.dof(); ++j) {
      std::vector<std::string> cells = {j == 0 ? c.estimator : "", std::to_string(j + 1)};
      for (const Metric m : kShown) cells.push_back(fmt::format("{:.6g}", s.joint(m, j)));
      table.add(std::move(cells));
    }
    const std::string v = verdict(s);
    if (v.empty()) continue;
    if (trace.has_truth()) table.add_note("  " + c.detector + ": " + v);
    verdicts += fmt::format("{} behind {}: {}\n", c.detector, c.estimator, v);
  }
  fmt::print(to, "{}", table.empty() ? verdicts : table.format());
}

void print_forces(const Trace& trace, const std::vector<Replayed>& all, std::FILE* to) {
  for (const Replayed& c : all) {
    const auto size = [](const Acting& a) { return a.force.force.norm(); };
    const auto largest =
        std::max_element(c.acting.begin(), c.acting.end(),
                         [&](const Acting& a, const Acting& b) { return size(a) < size(b); });
    if (largest == c.acting.end()) continue;
    const int link = largest->touch.link + 1;
    fmt::print(to, "{}: the largest force is {:.4g} N, at {:.3f} s; {}\n", c.estimator,
               size(*largest), trace.t[static_cast<std::size_t>(largest - c.acting.begin())],
               touched_link(link, trace.dof()));
  }
}

}  // namespace tauext
