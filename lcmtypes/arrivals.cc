// SPDX-License-Identifier: Apache-2.0
#include "lcmtypes/arrivals.h"

#include <algorithm>

namespace tauext {

Arrival Arrivals::take(const Reading& r) noexcept {
  if (!any_ || r.utime > newest_) return accept(r, Arrival::kNext);
  if (r.utime == newest_) {
    ++counts_.repeated;
    return Arrival::kRepeated;
  }
  late_in_order_ = late_in_order_ > 0 && r.utime > last_late_ ? late_in_order_ + 1 : 1;
  last_late_ = r.utime;
  if (late_in_order_ >= kPatience) {
    ++counts_.restarts;
    any_ = false;
    periods_known_ = 0;
    return accept(r, Arrival::kRestart);
  }
  ++counts_.late;
  // it was counted as lost when the next one came first
  if (r.seq >= 0 && r.seq < newest_seq_ && counts_.lost > 0) --counts_.lost;
  return Arrival::kLate;
}

Arrival Arrivals::accept(const Reading& r, Arrival as) noexcept {
  if (any_) count_lost(r);
  any_ = true;
  newest_ = r.utime;
  newest_seq_ = r.seq;
  late_in_order_ = 0;
  ++counts_.used;
  return as;
}

void Arrivals::count_lost(const Reading& r) noexcept {
  if (r.seq >= 0 && newest_seq_ >= 0) {
    add_lost(r.seq - newest_seq_ - 1);
    return;
  }
  const std::int64_t step = r.utime - newest_;
  if (periods_known_ >= 5) {
    add_lost((step + period() / 2) / period() - 1);
  }
  periods_[periods_known_++ % periods_.size()] = step;
}

void Arrivals::add_lost(std::int64_t messages) noexcept {
  if (messages > 0 && messages <= kLargestLoss) counts_.lost += messages;
}

std::int64_t Arrivals::period() const noexcept {
  std::array<std::int64_t, 31> sorted = periods_;
  const std::size_t n = std::min(periods_known_, sorted.size());
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(n / 2);
  std::nth_element(sorted.begin(), middle, sorted.begin() + static_cast<std::ptrdiff_t>(n));
  return std::max<std::int64_t>(*middle, 1);
}

}  // namespace tauext
