// SPDX-License-Identifier: Apache-2.0
#include "lcmtypes/receive/arrivals.h"

#include <algorithm>
#include <cmath>

namespace tauext {
namespace {

// [rad] of the joint that differs most
double distance(const Joints& a, const Joints& b, int n) {
  double most = 0;
  for (int j = 0; j < n; ++j) most = std::max(most, std::abs(a[j] - b[j]));
  return most;
}

}  // namespace

Arrival Arrivals::take(const Reading& r, Sender sender, std::int64_t now) noexcept {
  const Senders::Whose whose = senders_.take(sender, now);
  if (whose == Senders::Whose::kOther) {
    ++counts_.rejected;
    return Arrival::kOther;
  }
  if (whose == Senders::Whose::kNew && any_) return start_anew(r);
  const bool newer = !any_ || r.utime > newest_;
  if (r.seq >= 0 && (newer || r.utime < newest_)) sequence_.take(r.seq);
  if (newer) {
    senders_.in_turn(now);
    look_for_jumps(r);
    return accept(r, Arrival::kNext);
  }
  senders_.out_of_turn(now);
  if (r.utime == newest_) {
    ++counts_.repeated;
    return Arrival::kRepeated;
  }
  late_in_order_ = late_in_order_ > 0 && r.utime > last_late_ ? late_in_order_ + 1 : 1;
  last_late_ = r.utime;
  if (late_in_order_ >= Sequence::kPatience) return start_anew(r);
  ++counts_.late;
  counts_.lost = lost_ + sequence_.counts().lost;
  return Arrival::kLate;
}

Arrival Arrivals::start_anew(const Reading& r) noexcept {
  ++counts_.restarts;
  if (r.seq >= 0) sequence_.restart(r.seq);
  any_ = false;
  doubtful_ = excused_ = 0;
  periods_known_ = 0;
  return accept(r, Arrival::kRestart);
}

Arrival Arrivals::accept(const Reading& r, Arrival as) noexcept {
  if (any_ && r.seq < 0) count_period(r.utime - newest_);
  counts_.lost = lost_ + sequence_.counts().lost;
  any_ = true;
  newest_ = r.utime;
  late_in_order_ = 0;
  excused_ = 0;
  ++counts_.used;
  return as;
}

void Arrivals::reject(const Stamp& stamp) noexcept {
  ++counts_.rejected;
  if (stamp.seq >= 0) {
    sequence_.excuse(stamp.seq);
    counts_.lost = lost_ + sequence_.counts().lost;
  } else if (any_ && stamp.utime > newest_) {
    ++excused_;
  }
}

void Arrivals::end(std::int64_t sent) noexcept {
  sequence_.end(sent);
  counts_.lost = lost_ + sequence_.counts().lost;
}

void Arrivals::count_period(std::int64_t step) noexcept {
  constexpr std::size_t kEnough = 5;
  constexpr std::int64_t kSmall = 64;  // periods
  lost_ += doubtful_;                  // time went on from there
  doubtful_ = 0;
  if (periods_known_ >= kEnough) {
    const std::int64_t missing =
        std::max<std::int64_t>((step + period() / 2) / period() - 1 - excused_, 0);
    (missing <= kSmall ? lost_ : doubtful_) += missing;
  }
  periods_[periods_known_++ % periods_.size()] = step;
}

std::int64_t Arrivals::period() const noexcept {
  std::array<std::int64_t, 31> sorted = periods_;
  const auto n = static_cast<std::ptrdiff_t>(std::min(periods_known_, sorted.size()));
  std::nth_element(sorted.begin(), sorted.begin() + n / 2, sorted.begin() + n);
  return std::max<std::int64_t>(sorted[n / 2], 1);
}

// far from the newest, and where the one before it was
void Arrivals::look_for_jumps(const Reading& r) noexcept {
  constexpr double kFar = 0.01;                // [rad] in one period
  constexpr std::int64_t kSecond = 1'000'000;  // [us]
  const double step = distance(r.q, before_[0], r.n), back = distance(r.q, before_[1], r.n);
  before_ = {r.q, before_[0]};
  if (counts_.used < 2 || step < kFar || back > step / 5) return;
  if (r.utime - jumps_since_ > kSecond) {
    jumps_since_ = r.utime;
    jumps_ = 0;
  }
  counts_.two_arms = counts_.two_arms || ++jumps_ >= Sequence::kPatience;
}

std::string Arrivals::trouble() {
  if (!counts_.two_arms || told_) return senders_.trouble();
  told_ = true;
  return "positions jump to and fro: two arms send on the channel";
}

}  // namespace tauext
