// SPDX-License-Identifier: Apache-2.0
#include "regression/accept.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <stdexcept>
#include <vector>

#include "mjcf/trace/atomic_file.h"
#include "mjcf/trace/input_file.h"
#include "regression/report/accepting.h"
#include "regression/report/findings.h"
#include "regression/update.h"

namespace tauext::gate {

namespace {

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
