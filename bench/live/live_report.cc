// SPDX-License-Identifier: Apache-2.0
#include "bench/live/live_report.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cmath>

#include "bench/score/metric_list.h"
#include "mjcf/arm_forces.h"
#include "mjcf/trace/table_writer.h"

namespace tauext::live {
namespace {

constexpr double kUs = 1e-3;  // from ns

std::string format_stream(const StreamReport& s) {
  if (!s.asked) return "stream     none; --lcm streams\n";
  return fmt::format("stream     {}: {} messages published, {} failed; {} samples dropped{}\n",
                     s.url, s.counts.published, s.counts.failed, s.counts.dropped,
                     s.hung ? "; it hangs, and was left" : "");
}

std::string format_loop(const LiveReport& r) {
  const Histogram& h = *r.late;
  return fmt::format(
      "loop       late by {:.0f} us (half of the cycles at most), {:.0f} us (99 %), {:.0f} us "
      "(all); "
      "a period is {:.0f} us\n",
      h.quantile(0.5) * kUs, h.quantile(0.99) * kUs, h.largest() * kUs, r.period * kUs);
}

std::string format_arrivals(const LiveReport& r) {
  const std::string refused = format(r.refused);
  return fmt::format("input      {}; {} restarts of the sender\n{}", format(r.arrivals, r.refused),
                     r.arrivals.restarts, refused.empty() ? "" : "refused    " + refused + "\n");
}

std::string number_or_dash(double value, int decimals = 3) {
  return std::isfinite(value) ? fmt::format("{:.{}f}", value, decimals) : "-";
}

// [us] that a share of the updates took at most
std::string step_us(const Histogram& h, double share) {
  return h.count() == 0 ? "-" : number_or_dash(h.quantile(share) * kUs, 2);
}

}  // namespace

std::string format(const LiveReport& r, const LiveEstimation& e) {
  std::string out = fmt::format("{}: {} samples in {:.1f} s\n", r.title, e.samples(), r.seconds);
  out += r.subscribed ? format_arrivals(r) : format_loop(r);
  out += format_stream(r.stream);
  TableWriter table({{"estimator", "", true},
                     {"rmse", "N m"},
                     {"max", "N m"},
                     {"step 50 %", "us"},
                     {"99 %", "us"},
                     {"all", "us"},
                     {"unusable", "samples"},
                     {"marks"}});
  for (int i = 0; i < e.size(); ++i) {
    const LiveFigures& f = e.figures(i);
    table.add({e.name(i), number_or_dash(f.rmse()),
               f.compared > 0 ? number_or_dash(f.largest_error) : "-", step_us(f.step_ns, 0.5),
               step_us(f.step_ns, 0.99), step_us(f.step_ns, 1), fmt::to_string(f.unusable.load()),
               fmt::to_string(f.marks.load())});
    if (f.largest_force > 0)
      table.add_note(fmt::format("  {}: the largest force is {:.4g} N; {}", e.name(i),
                                 f.largest_force.load(), touched_link(f.touched, e.dof())));
    if (const std::string said = f.counts.sentence(); !said.empty()) {
      table.add_note(fmt::format("  {}: {}", e.name(i), said));
    }
  }
  return out + "\n" + table.format();
}

std::vector<summary_t> summaries_of(const LiveReport& r, const LiveEstimation& e,
                                    const std::string& detector) {
  std::vector<summary_t> all;
  for (int i = 0; i < e.size(); ++i) {
    const LiveFigures& f = e.figures(i);
    summary_t m{};
    m.utime = std::chrono::duration_cast<std::chrono::microseconds>(
                  std::chrono::system_clock::now().time_since_epoch())
                  .count();
    m.program = "tauext-live " TAUEXT_VERSION;
    m.entry = r.title + "/" + e.name(i) + (detector.empty() ? "" : "+" + detector);
    m.rmse_Nm = f.compared > 0 ? f.rmse() : -1;
    m.step_ns = f.step_ns.quantile(0.5);
    m.samples = e.samples();
    m.rejected = r.arrivals.rejected;
    m.lost = r.arrivals.lost;
    const auto add = [&m](const std::string& key, double value) {
      m.key.emplace_back(key);
      m.value.push_back(value);
    };
    if (f.compared > 0) add(key_of(Metric::kMax), f.largest_error);
    add("step_p99_ns", f.step_ns.quantile(0.99));
    add("marks", static_cast<double>(f.marks));
    add("unusable", static_cast<double>(f.unusable));
    f.counts.for_each(
        [&](const std::string& key, std::int64_t n) { add(key, static_cast<double>(n)); });
    if (r.late != nullptr) add("late_p99_ns", r.late->quantile(0.99));
    m.n = static_cast<std::int32_t>(m.key.size());
    all.push_back(std::move(m));
  }
  return all;
}

void StatusLine::show(const LiveEstimation& e, const Histogram* late, const LiveStream* stream) {
  const auto now = std::chrono::steady_clock::now();
  if (!line_.shown() || now - shown_ < std::chrono::milliseconds(500)) return;
  shown_ = now;
  std::string line = fmt::format("{:.0f} s  {} samples",
                                 std::chrono::duration<double>(now - begin_).count(), e.samples());
  if (late != nullptr) {
    line += fmt::format("  late {:.0f} us (99 %), {:.0f} us (all)", late->quantile(0.99) * kUs,
                        late->largest() * kUs);
  }
  for (int i = 0; i < e.size(); ++i) {
    line += fmt::format("  {} {:.1f} us", e.name(i), e.figures(i).step_ns.quantile(0.99) * kUs);
  }
  if (stream != nullptr) {
    const LiveStream::Counts c = stream->counts();
    line += fmt::format("  {} published, {} failed, {} dropped", c.published, c.failed, c.dropped);
  }
  line_.show(line);
}

}  // namespace tauext::live
