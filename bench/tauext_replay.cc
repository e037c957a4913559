// SPDX-License-Identifier: Apache-2.0
// tauext-replay: runs estimators over a recorded log.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "bench/logs/lcm_trace.h"
#include "bench/logs/read_log.h"
#include "bench/program/program.h"
#include "bench/roster/robots.h"
#include "bench/score/detection_metrics.h"
#include "bench/score/metrics.h"
#include "mjcf/trace/atomic_file.h"
#include "mjcf/trace/known.h"
#include "mjcf/trace/printable.h"
#include "mjcf/trace/table_writer.h"

namespace {

using namespace tauext;

struct Column {
  std::string estimator, detector;
  Output output;
};

std::string marks_name(const Column& c, bool several) {
  return several ? fmt::format("{}_{}_mark", c.estimator, c.detector)
                 : fmt::format("{}_mark", c.detector);
}

void write_estimates(const Trace& trace, const std::vector<Column>& columns,
                     const std::string& path) {
  // with one estimator, <detector>_mark is unambiguous; with more, the estimator's name comes first
  const bool several = columns.size() > 1;
  fmt::memory_buffer out;
  const auto to = std::back_inserter(out);
  fmt::format_to(to, "t");
  for (const Column& c : columns) {
    for (int j = 1; j <= trace.dof(); ++j) fmt::format_to(to, ",{}_tau_ext{}", c.estimator, j);
    fmt::format_to(to, ",{}_status", c.estimator);
    if (!c.output.marks.empty()) fmt::format_to(to, ",{}", marks_name(c, several));
  }
  fmt::format_to(to, "\n");
  for (int k = 0; k < trace.size(); ++k) {
    fmt::format_to(to, "{:.17g}", trace.t[k]);
    for (const Column& c : columns) {
      for (int j = 0; j < trace.dof(); ++j) fmt::format_to(to, ",{:.17g}", c.output.tau_ext(j, k));
      fmt::format_to(to, ",{}", static_cast<int>(c.output.status[k]));
      if (!c.output.marks.empty()) fmt::format_to(to, ",{}", int{c.output.marks[k]});
    }
    fmt::format_to(to, "\n");
  }
  AtomicFile file(path);  // not before all is ready: an interrupt leaves nothing behind
  file.write({out.data(), out.size()});
  file.commit();
}

// statuses that an engineer has to know of; false if most samples could not be used
bool report_status(const Trace& trace, const Column& c) {
  std::map<Status, int> count;
  for (const Status s : c.output.status) ++count[s];
  const int good = count[Status::kOk];
  const int restarts = std::max(count[Status::kStarted] - 1, 0);
  if (good + 1 >= trace.size()) return true;
  say(fmt::format(
      "{}: {} samples ignored as out of range, {} restarts after gaps, {} divergences, {} with a "
      "singular inertia",
      c.estimator, count[Status::kBadMeasurement], restarts, count[Status::kDiverged],
      count[Status::kSingularInertia]));
  if (2 * good >= trace.size()) return true;
  std::vector<double> steps;
  for (int k = 1; k < trace.size(); ++k) steps.push_back(trace.t[k] - trace.t[k - 1]);
  std::nth_element(steps.begin(), steps.begin() + steps.size() / 2, steps.end());
  say(fmt::format(
      "{}: most samples could not be used, so these are no estimates. Is t in s, q in rad, qd in "
      "rad/s, tau in N m? Samples are {:g} s apart; more than 0.05 s is a gap",
      c.estimator, steps[steps.size() / 2]));
  return false;
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
                                                        *s.get(Metric::kRecall), *delay));
}

void print_metrics(const Trace& trace, const std::vector<Column>& columns, double score_from,
                   std::FILE* to) {
  constexpr Metric kShown[] = {Metric::kRmse, Metric::kBias, Metric::kMax};
  std::vector<TableWriter::Column> titles = {{.title = "estimator", .left = true},
                                             {.title = "joint"}};
  for (const Metric m : kShown) {
    titles.push_back({title_of(m), std::string(row_of(m).unit)});
  }
  TableWriter table(std::move(titles));
  for (const Column& c : columns) {
    Score s;
    if (trace.has_truth()) add_error_metrics(trace, c.output, score_from, s);
    add_detection_metrics(trace, c.output, s);
    for (int j = 0; trace.has_truth() && j < trace.dof(); ++j) {
      std::vector<std::string> cells = {j == 0 ? c.estimator : "", std::to_string(j + 1)};
      for (const Metric m : kShown) cells.push_back(fmt::format("{:.6g}", s.joint(m, j)));
      table.add(std::move(cells));
    }
    if (const std::string v = verdict(s); !v.empty()) table.add_note("  " + c.detector + ": " + v);
  }
  if (!table.empty()) fmt::print(to, "{}", table.format());
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "Runs estimators over a recorded log (an LCM log, or CSV with the columns of tauext-record;\n"
      "tau_ext and contact may be missing) and writes their estimates, one row per usable sample.\n"
      "Status: 0 ok, 1 started, 2 bad sample, 3 singular inertia, 4 diverged (old estimate held).\n"
      "With the truth in the log, prints the errors too. Exit code 1 if most rows or samples "
      "were unusable.\n\n"
      "  tauext-replay log.csv --robot wallmobot3 --estimator ekf,ndob --out est.csv\n",
      "tauext-replay");
  std::string log, channel, robot_name, detector, out;
  std::vector<std::string> estimators;
  double score_from = -std::numeric_limits<double>::infinity();
  bool list = false;
  app.add_option("log", log, "log to read: CSV or LCM");
  app.add_option("--channel", channel, "of an LCM log with several that hold measurements");
  app.add_option("--robot", robot_name, "robot (see --list), or its MJCF file")
      ->type_name("NAME|FILE.xml");
  app.add_option("--estimator", estimators, "NAME[:KEY=VALUE].., one or more apart by commas")
      ->delimiter(',')
      ->allow_extra_args(false);
  app.add_option("--detector", detector, "NAME[:KEY=VALUE].. behind each estimator");
  app.add_option("--out", out, "file to write; - is standard output");
  app.add_option("--score_from", score_from,
                 "errors count from this time on [s]; else from the begin")
      ->type_name("S");
  app.add_flag("--list", list, "list robots, estimators and detectors, and stop");
  return run_program(app, argc, argv, [&] {
    if (list) {
      fmt::print("{}", list_known());
      return kGood;
    }
    if (log.empty() || robot_name.empty() || estimators.empty() || out.empty()) {
      throw std::invalid_argument(
          "a log, --robot, --estimator and --out are required; see tauext-replay --help");
    }
    if (is_lcm_log(out)) {
      throw std::invalid_argument(fmt::format("--out {}: estimates are written as CSV", out));
    }
    refuse_twice("estimator", estimators);
    const Robot& r = robot(robot_name);
    for (const std::string& e : estimators) r.check(e, detector);
    const RecordedLog recorded = read_log_or_csv(log, channel);
    const Trace& trace = recorded.trace;
    if (!(score_from <= trace.t.back())) {
      throw std::invalid_argument(
          fmt::format("--score_from {}: the log ends at {} s", score_from, trace.t.back()));
    }
    std::vector<Column> columns;
    for (const std::string& e : estimators) {
      columns.push_back({e, detector, r.runner(e, detector, trace)->run()});
    }
    bool good = recorded.usable();
    for (const Column& c : columns) good = report_status(trace, c) && good;
    write_estimates(trace, columns, out);
    print_metrics(trace, columns, score_from, out == "-" ? stderr : stdout);
    return good ? kGood : kAnswerIsNo;
  });
}
