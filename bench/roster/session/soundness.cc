// SPDX-License-Identifier: Apache-2.0
#include "bench/roster/session/soundness.h"

#include <fmt/format.h>

namespace tauext {

void Soundness::look(double t, Status status, bool is_finite) {
  const bool fails = status == Status::kSingularInertia || status == Status::kDiverged;
  if ((is_finite && !fails) || !why_.empty()) return;
  why_ = fmt::format("{} at t = {} s", is_finite ? name_of(status) : "not finite", t);
}

std::string Soundness::why(std::int64_t samples) const {
  if (!why_.empty() || 2 * counts_.left_out() <= samples) return why_;
  const bool gaps = 2 * counts_.of(Status::kBadTime) > samples;
  return fmt::format(
      "{} of {} samples left out: {}{}", counts_.left_out(), samples, counts_.text(),
      gaps ? "; a step of more than `max_gap` [s] counts as a gap, and the estimator's "
             "specification sets it, like mo2:max_gap=0.4"
           : "");
}

}  // namespace tauext
