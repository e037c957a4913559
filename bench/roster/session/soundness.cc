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
  return fmt::format("{} of {} samples left out: {}", counts_.left_out(), samples, counts_.text());
}

}  // namespace tauext
