// SPDX-License-Identifier: Apache-2.0
#include "regression/accept.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <set>
#include <stdexcept>
#include <vector>

#include "mjcf/trace/atomic_file.h"
#include "mjcf/trace/input_file.h"
#include "regression/report/findings.h"
#include "regression/update.h"

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
    if (slower) {
      // another day's machine may say a tenth more
      const double at_most = k.verdict.high - 1 + 0.1 * (k.verdict.ratio - 1);
      all.push_back({kTimeLayer, k.kernel, k.verdict.surely, at_most,
                     [&v = k.verdict](const std::string& reason) {
                       v.verdict = Verdict::kAccepted;
                       v.why = reason;
                     }});
    }
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

// all of these names and no other
std::string filter_of(const std::set<std::string>& names) {
  std::string filter;
  for (const std::string& name : names) filter += (filter.empty() ? "" : "|") + exactly(name);
  return filter;
}

// what was committed and is not so any more
void move_committed(const GateOptions& options, const std::string& base, const std::string& reason,
                    GateResult& r) {
  std::set<std::string> kernels, entries;
  if (r.instructions) {
    for (const CountChange& c : r.instructions->beside_committed) {
      if (!c.accepted.empty()) kernels.insert(c.kernel);
    }
  }
  if (r.accuracy) {
    for (const MetricChange& c : r.accuracy->changes) {
      if (!c.accepted.empty()) entries.insert(c.entry);
    }
  }
  if (kernels.empty() && entries.empty()) return;
  const UpdateResult moved = update_baselines({.baselines = options.baselines,
                                               .changelog = options.changelog,
                                               .reason = "accepted beside " + base.substr(0, 12),
                                               .accept_worse = reason,
                                               .head = kernels.empty() ? "" : options.head,
                                               .bench = entries.empty() ? "" : options.bench,
                                               .kernels = filter_of(kernels),
                                               .entries = filter_of(entries)});
  if (moved.code != kGood) throw std::runtime_error(moved.text);
  r.notes.push_back(fmt::format("the committed numbers of {} kernels and {} entries moved",
                                kernels.size(), entries.size()));
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

void accept_findings(const GateOptions& options, const std::string& base, const std::string& reason,
                     GateResult& r) {
  const std::string path = accepted_path(options.baselines);
  std::vector<Acceptance> all = read_acceptances(path);
  // committed numbers moved when they were accepted: what differs from them now is another finding
  std::vector<Acceptance> standing = all;
  std::erase_if(standing, [](const Acceptance& a) {
    return a.layer == kCommittedLayer || a.layer == kAccuracyLayer;
  });
  if (reason.empty()) return accept(standing, base, r);
  if (reason.find_first_of("\r\n\t") != std::string::npos) {
    throw std::invalid_argument("--accept: one line");
  }
  std::erase_if(all, [&](const Acceptance& a) { return a.base != base; });
  std::erase_if(standing, [&](const Acceptance& a) { return a.base != base; });
  accept(standing, base, r);
  const std::vector<Acceptance> added = acceptable(r, base, reason);
  const GateResult refused = r;
  std::erase_if(all, [&](const Acceptance& a) {
    return std::any_of(added.begin(), added.end(), [&](const Acceptance& b) {
      return a.layer == b.layer && a.subject == b.subject;
    });
  });
  all.insert(all.end(), added.begin(), added.end());
  accept(added, base, r);
  const ExitCode left = exit_code(r);
  if (left == kCouldNotRun || left == kSlower || left == kLessAccurate) {
    r = refused;  // baselines that moved with it would hide what is left
    r.notes.push_back(
        fmt::format("nothing was accepted: {} of the findings could be, and what is left cannot",
                    added.size()));
    return;
  }
  move_committed(options, base, reason, r);
  release_input(path);  // it is made of what it was
  AtomicFile file(path);
  file.write(format_acceptances(all));
  file.commit();
  r.notes.push_back(fmt::format("{} findings accepted in {}", added.size(), path));
}

}  // namespace tauext::gate
