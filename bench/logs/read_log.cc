// SPDX-License-Identifier: Apache-2.0
#include "bench/logs/read_log.h"

#include <fmt/format.h>

#include <stdexcept>
#include <utility>

#include "bench/logs/lcm_trace.h"
#include "mjcf/trace/printable.h"
#include "mjcf/trace/timed_rows.h"

namespace tauext {
namespace {

// what read_csv left out, if anything
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

RecordedLog read_either(const std::string& path, const std::string& channel) {
  if (is_lcm_log(path)) {
    LogReport report;
    Trace trace = read_lcm(path, channel, &report);
    if (const std::string faults = report.in_words(); !faults.empty()) {
      say(fmt::format("{}: channel {}: {}", path, report.channel, faults));
    }
    return {std::move(trace), report.rejected + report.out_of_order};
  }
  if (!channel.empty()) {
    throw std::invalid_argument(fmt::format("{}: CSV has no channel '{}'", path, channel));
  }
  SkippedRows skipped;
  Trace trace = read_csv(path, &skipped);
  report_skipped(skipped, path);
  return {std::move(trace), skipped.total()};
}

}  // namespace

RecordedLog read_log_or_csv(const std::string& path, const std::string& channel) {
  RecordedLog log = read_either(path, channel);
  if (!log.usable()) {
    say(fmt::format("{}: most of it could not be used: {} skipped, {} used", path, log.skipped,
                    log.trace.size()));
  }
  return log;
}

}  // namespace tauext
