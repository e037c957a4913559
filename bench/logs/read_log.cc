// SPDX-License-Identifier: Apache-2.0
#include "bench/logs/read_log.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>
#include <vector>

#include "bench/logs/lcm_trace.h"
#include "mjcf/trace/printable.h"
#include "mjcf/trace/read/recording.h"

namespace tauext {
namespace {

// what was left out, if anything
void report_skipped(const SkippedRows& s, const std::string& log) {
  for (const std::string& note : s.notes) say(log + ": " + note);
  if (s.total() == 0) return;
  say(
      fmt::format("{}: skipped {} rows: {} with a wrong number of fields, {} not a number, {} not "
                  "finite, {} with a time that is not the next one",
                  log, s.total(), s.wrong_field_count, s.not_a_number, s.not_finite, s.time_order));
  for (const std::string& line : s.first) say("  " + line);
  if (s.total() > static_cast<int>(s.first.size())) say("  ...");
}

double median_step(const std::vector<double>& t) {
  std::vector<double> steps;
  for (std::size_t k = 1; k < t.size(); ++k) steps.push_back(t[k] - t[k - 1]);
  if (steps.empty()) return 0;
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::nth_element(steps.begin(), middle, steps.end());
  return *middle;
}

// Says what can hardly be s, rad and rad/s; whether q and qd cannot both be.
bool doubt_units(const Trace& log, const std::string& path, const std::string& remedy) {
  constexpr double kTwoTurns = 12.6;              // [rad]
  constexpr double kMoved = 0.1;                  // [rad], more than a joint at rest trembles
  constexpr double kLongestGap = 0.1;             // [s]
  const double longest = 5 * median_step(log.t);  // [s] over a gap qd says nothing
  bool contradicts = false, far = false;
  for (int j = 0; j < log.dof() && log.size() > 1; ++j) {
    double xx = 0, xy = 0, yy = 0;  // of the steps of q, by qd and by q
    for (int k = 1; k < log.size(); ++k) {
      const double h = log.t[k] - log.t[k - 1];
      if (h > longest) continue;
      const double x = h * (log.qd(j, k) + log.qd(j, k - 1)) / 2, y = log.q(j, k) - log.q(j, k - 1);
      xx += x * x, xy += x * y, yy += y * y;
    }
    const bool rests = xx < 1e-6 * yy;
    const bool moved = log.q.row(j).maxCoeff() - log.q.row(j).minCoeff() > kMoved;
    const bool alike = std::abs(xy) > 0.9 * std::sqrt(xx * yy);
    const bool wrong = rests ? moved : alike && (xy > 2 * xx || xy < 0.5 * xx);
    if (wrong && !contradicts) {
      const std::string what =
          rests ? fmt::format("q{} moves, and qd{} says that it rests", j + 1, j + 1)
                : fmt::format("q{} moves {:.3g} times as fast as qd{} says", j + 1, xy / xx, j + 1);
      say(fmt::format("{}: {}: {}", path, what, remedy));
    }
    contradicts = contradicts || wrong;
    const double most = log.q.row(j).cwiseAbs().maxCoeff();
    if (!far && most > kTwoTurns)
      say(fmt::format("{}: q{} reaches {:.3g}, more than two turns: {}", path, j + 1, most,
                      remedy));
    far = far || most > kTwoTurns;
  }
  if (log.size() > 2 && log.t.back() - log.t.front() > kLongestGap * log.size())
    say(fmt::format("{}: the samples are {:.3g} apart on average: {}", path,
                    (log.t.back() - log.t.front()) / (log.size() - 1), remedy));
  if (contradicts)
    say(path + ": q and qd contradict each other, so that no estimate from them means anything");
  return contradicts;
}

constexpr const char* kUnits = "are t, q and qd in s, rad and rad/s, with the same sign?";

RecordedLog read_lcm_log(const std::string& path, const LogOptions& o) {
  if (!o.columns.empty())
    throw std::invalid_argument(fmt::format("{}: an LCM log has no columns to map", path));
  LogReport report;
  Trace trace = read_lcm(path, o.channel, &report);
  if (const std::string faults = report.in_words(); !faults.empty())
    say(fmt::format("{}: channel {}: {}", path, report.channel, faults));
  const bool contradicts = doubt_units(trace, path, kUnits);
  return {std::move(trace), report.rejected + report.out_of_order, contradicts};
}

RecordedLog read_rows(const std::string& path, const LogOptions& o) {
  SkippedRows skipped;
  Regularity regularity;
  Trace trace =
      read_recording(path, {.columns = o.columns, .topic = o.channel}, &skipped, &regularity);
  report_skipped(skipped, path);
  if (trace.tau_is_current && !o.currents)
    throw std::runtime_error(
        path + ": [current] needs `gain` [N m/A], a number for each drive, in the map of columns");
  if (!o.columns.empty() || regularity.gaps > 0) say(path + ": " + regularity.in_words());
  const bool contradicts =
      doubt_units(trace, path, std::string(kUnits) + " --columns takes other units and signs");
  return {std::move(trace), skipped.total(), contradicts};
}

}  // namespace

void RecordedLog::require_consistent(const std::string& path) const {
  if (contradicts)
    throw std::invalid_argument(path + ": q and qd contradict each other, so nothing is learnt");
}

RecordedLog read_any_log(const std::string& path, const LogOptions& o) {
  RecordedLog log = is_lcm_log(path) ? read_lcm_log(path, o) : read_rows(path, o);
  if (log.skipped > log.trace.size()) {
    say(fmt::format("{}: most of it could not be used: {} skipped, {} used", path, log.skipped,
                    log.trace.size()));
  }
  return log;
}

}  // namespace tauext
