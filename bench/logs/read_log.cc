// SPDX-License-Identifier: Apache-2.0
#include "bench/logs/read_log.h"

#include <fmt/format.h>

#include "bench/logs/lcm_trace.h"

namespace tauext {
namespace {

// what read_csv left out, if anything
void report_skipped(const SkippedRows& s, const std::string& log) {
  if (s.total() == 0) return;
  fmt::print(
      stderr,
      "{}: skipped {} rows: {} with a wrong number of fields, {} not a number, {} not finite, "
      "{} out of time order\n",
      log, s.total(), s.wrong_field_count, s.not_a_number, s.not_finite, s.time_order);
  for (const std::string& line : s.first) fmt::print(stderr, "  {}\n", line);
  if (s.total() > static_cast<int>(s.first.size())) fmt::print(stderr, "  ...\n");
}

}  // namespace

Trace read_log_or_csv(const std::string& path, const std::string& channel) {
  if (!is_lcm_log(path)) {
    if (!channel.empty()) {
      throw std::invalid_argument(fmt::format("{}: CSV has no channel '{}'", path, channel));
    }
    SkippedRows skipped;
    Trace trace = read_csv(path, &skipped);
    report_skipped(skipped, path);
    return trace;
  }
  LogReport report;
  Trace trace = read_lcm(path, channel, &report);
  if (const std::string faults = report.in_words(); !faults.empty()) {
    fmt::print(stderr, "{}: channel {}: {}\n", path, report.channel, faults);
  }
  return trace;
}

}  // namespace tauext
