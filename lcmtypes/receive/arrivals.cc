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
  if (r.seq >= 0) sequence_.take(r.seq);
  if (newer) {
    senders_.in_turn(now);
    look_for_jumps(r);
    return accept(r, Arrival::kNext);
  }
  if (r.utime == newest_) {
    senders_.out_of_turn(now);
    ++counts_.repeated;
    count_lost();
    return Arrival::kRepeated;
  }
  late_in_order_ = late_in_order_ > 0 && r.utime > last_late_ ? late_in_order_ + 1 : 1;
  last_late_ = r.utime;
  if (late_in_order_ >= Sequence::kPatience) {
    senders_.in_turn(now);
    return start_anew(r);
  }
  senders_.out_of_turn(now);
  if (r.seq < 0) find_again(r.utime);
  ++counts_.late;
  count_lost();
  return Arrival::kLate;
}

void Arrivals::count_lost() noexcept {
  counts_.lost = lost_ + sequence_.counts().lost;
}

// one of a gap that came late after all
void Arrivals::find_again(std::int64_t utime) noexcept {
  for (Gap& gap : gaps_) {
    if (gap.missing == 0 || utime <= gap.from || utime >= gap.to) continue;
    --gap.missing;
    --lost_;
    return;
  }
}

Arrival Arrivals::start_anew(const Reading& r) noexcept {
  ++counts_.restarts;
  if (r.seq >= 0) sequence_.restart(r.seq);
  any_ = false;
  doubtful_ = excused_ = 0;
  gaps_.fill({});
  periods_known_ = 0;
  return accept(r, Arrival::kRestart);
}

Arrival Arrivals::accept(const Reading& r, Arrival as) noexcept {
  if (any_ && r.seq < 0) count_period(r.utime);
  count_lost();
  any_ = true;
  newest_ = r.utime;
  late_in_order_ = 0;
  excused_ = 0;
  ++counts_.used;
  return as;
}

void Arrivals::reject(const Stamp& stamp, Sender sender) noexcept {
  ++counts_.rejected;
  if (!senders_.is_ours(sender)) return;
  if (stamp.seq >= 0) {
    sequence_.excuse(stamp.seq);
    count_lost();
  } else if (any_ && stamp.utime > newest_) {
    ++excused_;
  }
}

void Arrivals::end(std::int64_t sent, Sender sender) noexcept {
  if (!senders_.is_ours(sender)) return;
  sequence_.end(sent);
  senders_.end();
  count_lost();
}

void Arrivals::count_period(std::int64_t utime) noexcept {
  const std::int64_t step = utime - newest_;
  constexpr std::size_t kEnough = 5;
  constexpr std::int64_t kSmall = 64;  // periods
  lost_ += doubtful_;                  // time went on from there
  doubtful_ = 0;
  if (periods_known_ >= kEnough) {
    const std::int64_t missing =
        std::max<std::int64_t>((step + period() / 2) / period() - 1 - excused_, 0);
    if (missing > kSmall) {
      doubtful_ += missing;
    } else if (missing > 0) {
      lost_ += missing;
      gaps_[oldest_gap_] = {newest_, utime, missing};
      oldest_gap_ = (oldest_gap_ + 1) % gaps_.size();
    }
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
