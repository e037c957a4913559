// SPDX-License-Identifier: Apache-2.0
#include "lcmtypes/arrivals.h"

#include <algorithm>

namespace tauext {

Arrival Arrivals::take(const Reading& r) noexcept {
  const bool newer = !any_ || r.utime > newest_;
  if (r.seq >= 0 && (newer || r.utime < newest_)) {
    sequence_.take(r.seq);
    counts_.lost = sequence_.lost();
  }
  if (newer) return accept(r, Arrival::kNext);
  if (r.utime == newest_) {
    ++counts_.repeated;
    return Arrival::kRepeated;
  }
  late_in_order_ = late_in_order_ > 0 && r.utime > last_late_ ? late_in_order_ + 1 : 1;
  last_late_ = r.utime;
  if (late_in_order_ < Sequence::kPatience) {
    ++counts_.late;
    return Arrival::kLate;
  }
  ++counts_.restarts;
  if (r.seq >= 0) sequence_.restart(r.seq);
  any_ = false;
  periods_known_ = 0;
  return accept(r, Arrival::kRestart);
}

Arrival Arrivals::accept(const Reading& r, Arrival as) noexcept {
  if (any_ && r.seq < 0) count_period(r.utime - newest_);
  any_ = true;
  newest_ = r.utime;
  late_in_order_ = 0;
  ++counts_.used;
  return as;
}

void Arrivals::count_period(std::int64_t step) noexcept {
  constexpr std::size_t kEnough = 5;
  if (periods_known_ >= kEnough) {
    const std::int64_t missing = (step + period() / 2) / period() - 1;
    if (missing > 0 && missing <= Sequence::kLargestLoss) counts_.lost += missing;
  }
  periods_[periods_known_++ % periods_.size()] = step;
}

std::int64_t Arrivals::period() const noexcept {
  std::array<std::int64_t, 31> sorted = periods_;
  const auto n = static_cast<std::ptrdiff_t>(std::min(periods_known_, sorted.size()));
  std::nth_element(sorted.begin(), sorted.begin() + n / 2, sorted.begin() + n);
  return std::max<std::int64_t>(sorted[n / 2], 1);
}

}  // namespace tauext
