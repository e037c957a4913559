// SPDX-License-Identifier: Apache-2.0
#include "bench/logs/read_log.h"

#include <fmt/format.h>

#include <cmath>
#include <stdexcept>
#include <utility>

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

// Says what can hardly be s, rad and rad/s; whether q and qd cannot both be.
bool doubt_units(const Trace& log, const std::string& path) {
  constexpr double kTwoTurns = 12.6;   // [rad]
  constexpr double kLongestGap = 0.1;  // [s]
  constexpr const char* kRemedy =
      "are t, q and qd in s, rad and rad/s? --columns tells other units";
  for (int j = 0; j < log.dof(); ++j) {
    double xx = 0, xy = 0, yy = 0;  // of the steps of q, by qd and by q
    for (int k = 1; k < log.size(); ++k) {
      const double h = log.t[k] - log.t[k - 1];
      const double x = h * (log.qd(j, k) + log.qd(j, k - 1)) / 2, y = log.q(j, k) - log.q(j, k - 1);
      xx += x * x, xy += x * y, yy += y * y;
    }
    const double times = xy / xx;
    if (xy > 0.9 * std::sqrt(xx * yy) && (times > 2 || times < 0.5)) {
      say(fmt::format("{}: q{} moves {:.3g} times as fast as qd{} says: {}", path, j + 1, times,
                      j + 1, kRemedy));
      return true;
    }
    if (const double most = log.q.row(j).cwiseAbs().maxCoeff(); most > kTwoTurns) {
      say(fmt::format("{}: q{} reaches {:.3g}, more than two turns: {}", path, j + 1, most,
                      kRemedy));
      return false;
    }
  }
  if (log.size() > 2 && log.t.back() - log.t.front() > kLongestGap * log.size())
    say(fmt::format("{}: the samples are {:.3g} apart on average: {}", path,
                    (log.t.back() - log.t.front()) / (log.size() - 1), kRemedy));
  return false;
}

RecordedLog read_lcm_log(const std::string& path, const LogOptions& o) {
  if (!o.columns.empty())
    throw std::invalid_argument(fmt::format("{}: an LCM log has no columns to map", path));
  LogReport report;
  Trace trace = read_lcm(path, o.channel, &report);
  if (const std::string faults = report.in_words(); !faults.empty())
    say(fmt::format("{}: channel {}: {}", path, report.channel, faults));
  return {std::move(trace), report.rejected + report.out_of_order};
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
  const bool contradicts = trace.size() > 0 && doubt_units(trace, path);
  return {std::move(trace), skipped.total(), contradicts};
}

}  // namespace

void RecordedLog::require_consistent(const std::string& path) const {
  if (contradicts)
    throw std::invalid_argument(
        path +
        ": nothing is learnt from q and qd that contradict each other; --columns tells units");
}

RecordedLog read_any_log(const std::string& path, const LogOptions& o) {
  RecordedLog log = is_lcm_log(path) ? read_lcm_log(path, o) : read_rows(path, o);
  if (!log.usable()) {
    say(fmt::format("{}: most of it could not be used: {} skipped, {} used", path, log.skipped,
                    log.trace.size()));
  }
  return log;
}

}  // namespace tauext
