// SPDX-License-Identifier: Apache-2.0
#include "regression/accept.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>
#include <vector>

#include "mjcf/trace/atomic_file.h"
#include "mjcf/trace/input_file.h"
#include "regression/report/accepting.h"

namespace tauext::gate {

void accept_findings(const std::string& baselines, const std::string& base,
                     const std::string& reason, GateResult& r) {
  const std::string path = accepted_path(baselines);
  std::vector<Acceptance> all = read_acceptances(path);
  if (reason.empty()) return accept(all, base, r);
  if (base.empty()) throw std::invalid_argument("--accept: beside which --base-commit?");
  if (reason.find_first_of("\r\n\t") != std::string::npos) {
    throw std::invalid_argument("--accept: one line");
  }
  std::erase_if(all, [&](const Acceptance& a) { return a.base != base; });
  accept(all, base, r);
  const std::vector<Acceptance> added = acceptable(r, base, reason);
  std::erase_if(all, [&](const Acceptance& a) {
    return std::any_of(added.begin(), added.end(), [&](const Acceptance& b) {
      return a.layer == b.layer && a.subject == b.subject;
    });
  });
  all.insert(all.end(), added.begin(), added.end());
  release_input(path);  // it is made of what it was
  AtomicFile file(path);
  file.write(format_acceptances(all));
  file.commit();
  r.notes.push_back(fmt::format("{} findings accepted in {}", added.size(), path));
  accept(added, base, r);
}

}  // namespace tauext::gate
