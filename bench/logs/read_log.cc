// SPDX-License-Identifier: Apache-2.0
#include "bench/logs/read_log.h"

#include <fmt/format.h>

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
  return {std::move(trace), skipped.total()};
}

}  // namespace

RecordedLog read_any_log(const std::string& path, const LogOptions& o) {
  RecordedLog log = is_lcm_log(path) ? read_lcm_log(path, o) : read_rows(path, o);
  if (!log.usable()) {
    say(fmt::format("{}: most of it could not be used: {} skipped, {} used", path, log.skipped,
                    log.trace.size()));
  }
  return log;
}

}  // namespace tauext
