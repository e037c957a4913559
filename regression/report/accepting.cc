// SPDX-License-Identifier: Apache-2.0
#include "regression/report/accepting.h"

#include <fmt/format.h>

#include <cmath>
#include <functional>

namespace tauext::gate {
namespace {

// layer, subject, by how much it is worse, what to write down; where the reason goes; and whether
// it fails by itself, or is what another day's run may say of the same
struct Excess {
  const char* layer;
  std::string subject;
  double by, at_most;
  std::function<void(const std::string&)> accept;
  bool fails = true;
};

void add_times(TimeReport& t, std::vector<Excess>& all) {
  for (KernelTime& k : t.kernels) {
    const bool slower = k.verdict.verdict == Verdict::kFail;
    const auto add = [&](const char* layer, TimeVerdict& v) {
      const bool fails = v.verdict == Verdict::kFail;
      if (!fails && !(slower && v.ratio > 1)) return;
      // another day's machine may say a tenth more
      const double at_most = v.high - 1 + 0.1 * (v.ratio - 1);
      all.push_back({layer, k.kernel, v.surely, at_most,
                     [&v](const std::string& reason) {
                       v.verdict = Verdict::kAccepted;
                       v.why = reason;
                     },
                     fails});
    };
    add(kTimeLayer, k.verdict);
    add(kColdLayer, k.cold);
    if (k.life.kernel.empty() || k.life.head.waits > k.life.base.waits) continue;
    const bool fails = !complaint(k.life).empty();
    const double by = std::max(k.life.worst_ratio, k.life.head.mean_ns / k.life.base.mean_ns) - 1;
    if (!fails && !(slower && by > 0)) continue;
    all.push_back({kLongLayer, k.kernel, by, 1.5 * by,
                   [&k](const std::string& reason) { k.life_accepted = reason; }, fails});
  }
}

void add_counts(const char* layer, std::vector<CountChange>& changes, std::vector<Excess>& all) {
  for (CountChange& c : changes) {
    if (!too_many(c)) continue;
    all.push_back({layer, c.kernel, c.change(), c.change() + 1e-4,
                   [&c](const std::string& reason) { c.accepted = reason; }});
  }
}

void add_metrics(AccuracyReport& r, std::vector<Excess>& all) {
  for (MetricChange& c : r.changes) {
    // what some seed never has has no mean, and a change of it no size
    const bool never = std::isnan(c.before) && std::isnan(c.after);
    const double by = never ? 0 : std::abs(c.after / c.before - 1);
    if (!std::isfinite(by)) continue;
    all.push_back({kAccuracyLayer, c.entry + " " + c.metric, by, by * (1 + 1e-4),
                   [&c](const std::string& reason) { c.accepted = reason; }});
  }
}

std::vector<Excess> excesses(GateResult& r) {
  std::vector<Excess> all;
  if (r.time) add_times(*r.time, all);
  if (r.instructions) {
    add_counts(kInstructionsLayer, r.instructions->beside_base, all);
    add_counts(kCommittedLayer, r.instructions->beside_committed, all);
  }
  if (r.accuracy) add_metrics(*r.accuracy, all);
  return all;
}

}  // namespace

std::vector<Acceptance> acceptable(const GateResult& result, const std::string& base,
                                   const std::string& reason) {
  GateResult copy = result;
  std::vector<Acceptance> all;
  for (const Excess& f : excesses(copy)) {
    all.push_back({f.layer, f.subject, f.at_most, base, reason});
  }
  return all;
}

void accept(const std::vector<Acceptance>& all, const std::string& base, GateResult& r) {
  int stale = 0;
  for (const Acceptance& a : all) stale += a.base != base;
  if (stale > 0) {
    r.notes.push_back(
        fmt::format("{} accepted findings are stale, of another base than {}: they accept nothing",
                    stale, base.empty() ? "none" : base.substr(0, 12)));
  }
  for (const Excess& f : excesses(r)) {
    if (!f.fails) continue;
    for (const Acceptance& a : all) {
      if (a.base != base || a.layer != f.layer || a.subject != f.subject) continue;
      if (a.covers(f.layer, f.subject, f.by)) {
        f.accept(fmt::format("accepted up to {:+.3g} %: {}", 100 * a.at_most, a.reason));
      } else {
        r.notes.push_back(fmt::format("{} of {}: {:+.3g} % are accepted ({}), and this is more",
                                      f.layer, f.subject, 100 * a.at_most, a.reason));
      }
    }
  }
}

}  // namespace tauext::gate
