// SPDX-License-Identifier: Apache-2.0
#include "bench/replay/replayed.h"

#include <fmt/format.h>

#include <cmath>
#include <cstddef>
#include <utility>

#include "mjcf/trace/table_writer.h"

namespace tauext {
namespace {

// what a detector was worth
std::string verdict(const metrics::DetectionScore& s) {
  std::string alarms = fmt::format("{} false alarms, ", s.false_alarms);
  if (s.intended > 0)
    alarms += fmt::format("{} of {} touches on purpose marked, ", s.intended_marked, s.intended);
  if (s.collisions == 0) return alarms + "no collision in the log";
  if (s.detected == 0) return alarms + "no collision detected";
  const metrics::Interval i = metrics::share_interval(s.detected, s.collisions);
  return alarms + fmt::format("recall {:.3g} ({:.2f} to {:.2f} with 95 %), largest delay {:.3f} s",
                              static_cast<double>(s.detected) / s.collisions, i.low, i.high,
                              s.delay);
}

}  // namespace

Replayed::Replayed(Setup setup, Pair pair, const RecordingContents& log)
    : setup_(std::move(setup)),
      pair_(std::move(pair)),
      tau_ext_(Eigen::VectorXd::Zero(log.dof)),
      errors_(log.has_truth ? static_cast<std::size_t>(log.dof) : 0) {}

void Replayed::take(const RecordedSample& y) {
  last_ = pair_.step(y.t, y.q.data(), y.qd.data(), y.tau.data(), tau_ext_.data());
  counts_.add(last_.status, last_.joints);
  if (y.t >= setup_.score_from) {
    for (std::size_t j = 0; j < errors_.size(); ++j) {
      const auto at = static_cast<Eigen::Index>(j);
      errors_[j].take(tau_ext_[at] - y.tau_ext[at]);
    }
  }
  if (!setup_.detector.empty()) marks_.take(y.t, y.contact, last_.detection.mark);
  if (setup_.forces == nullptr) return;
  acting_ = {setup_.forces->at_site(y.q.data(), tau_ext_.data()),
             setup_.forces->touch(y.q.data(), tau_ext_.data())};
  const double force = acting_.force.force.norm();
  if (force > largest_.force) largest_ = {force, y.t, acting_.touch.link + 1};
}

void print_metrics(const std::vector<Replayed>& all, const RecordingContents& log, std::FILE* to) {
  std::vector<TableWriter::Column> titles = {{.title = "estimator", .left = true},
                                             {.title = "joint"}};
  for (const Metric m : {Metric::kRmse, Metric::kBias, Metric::kMax}) {
    titles.push_back({title_of(m), std::string(row_of(m).unit)});
  }
  TableWriter table(std::move(titles));
  std::string verdicts;  // without a truth they stand alone
  for (const Replayed& c : all) {
    for (std::size_t j = 0; j < c.errors().size(); ++j) {
      std::vector<std::string> cells = {j == 0 ? c.estimator() : "", std::to_string(j + 1)};
      const metrics::Errors& e = c.errors()[j];
      for (const double figure : {e.rmse(), std::abs(e.bias()), e.max()})
        cells.push_back(fmt::format("{:.6g}", figure));
      table.add(std::move(cells));
    }
    if (c.detector().empty() || !log.has_contact) continue;
    const std::string v = verdict(c.marks());
    if (log.has_truth) table.add_note("  " + c.detector() + ": " + v);
    verdicts += fmt::format("{} behind {}: {}\n", c.detector(), c.estimator(), v);
  }
  fmt::print(to, "{}", table.empty() ? verdicts : table.format());
}

void print_forces(const std::vector<Replayed>& all, int dof, std::FILE* to) {
  for (const Replayed& c : all) {
    const Replayed::Largest& most = c.largest();
    if (most.force < 0) continue;
    fmt::print(to, "{}: the largest force is {:.4g} N, at {:.3f} s; {}\n", c.estimator(),
               most.force, most.t, touched_link(most.link, dof));
  }
}

}  // namespace tauext
