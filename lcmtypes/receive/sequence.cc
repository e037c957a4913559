// SPDX-License-Identifier: Apache-2.0
#include "lcmtypes/receive/sequence.h"

#include <algorithm>

namespace tauext {

Order Sequence::take(std::int64_t seq) noexcept {
  if (!any_) {
    any_ = true;
    next_ = seq;
  }
  if (ended_ && seq < next_ - 1 && !is_missing(seq)) {
    restart(seq);
    return Order::kRestart;
  }
  ended_ = ended_ && seq < next_;
  if (jump_.has(seq) && seq - jump_.from < kSmall) refuse_jump();
  return seq >= next_ ? take_ahead(seq) : take_behind(seq);
}

Order Sequence::take_ahead(std::int64_t seq) noexcept {
  if (jump_.size() > 0 && seq - next_ > kSmall) refuse_jump();  // nor did it go on from there
  settle_jump();
  const Gap gap{next_, seq};
  if (gap.size() > kSmall) {
    jump_ = gap;
  } else {
    miss(gap);
  }
  next_ = seq + 1;
  behind_ = behind_late_ = 0;
  ++counts_.next;
  return Order::kNext;
}

Order Sequence::take_behind(std::int64_t seq) noexcept {
  if (behind_ == 0 || seq <= last_behind_) behind_ = behind_late_ = 0;
  ++behind_;
  last_behind_ = seq;
  const bool late = fill(seq);
  behind_late_ += late;
  ++(late ? counts_.late : counts_.repeated);
  if (behind_ < kPatience) return late ? Order::kLate : Order::kRepeated;
  // none of them was what it seemed
  counts_.lost += behind_late_;
  counts_.late -= behind_late_;
  counts_.repeated -= behind_ - behind_late_;
  counts_.next += behind_ - 1;
  restart(seq);
  return Order::kRestart;
}

void Sequence::excuse(std::int64_t seq) noexcept {
  if (fill(seq) || seq < next_) return;
  if (std::find(excused_.begin(), excused_.end(), seq) != excused_.end()) return;
  excused_[oldest_excuse_] = seq;
  oldest_excuse_ = (oldest_excuse_ + 1) % excused_.size();
}

void Sequence::end(std::int64_t next) noexcept {
  if (jump_.size() > 0 && next <= jump_.to) refuse_jump();
  if (!any_ || next < next_) return;
  settle_jump();
  miss({next_, next});
  next_ = next;
  ended_ = true;
}

void Sequence::restart(std::int64_t seq) noexcept {
  missing_.fill({});
  excused_.fill(kNone);
  jump_ = {};
  any_ = true;
  ended_ = false;
  next_ = seq + 1;
  behind_ = behind_late_ = 0;
  ++counts_.restarts;
  ++counts_.next;
}

void Sequence::settle_jump() noexcept {
  miss(jump_);
  jump_ = {};
}

// the stream did not follow it: what jumped was another's
void Sequence::refuse_jump() noexcept {
  next_ = jump_.from;
  jump_ = {};
  --counts_.next;
  ++counts_.foreign;
}

void Sequence::miss(Gap gap) noexcept {
  if (gap.size() == 0) return;
  constexpr std::int64_t kMost = std::int64_t{1} << 58;  // whose sums cannot overflow
  counts_.lost = std::min(counts_.lost + gap.size(), kMost);
  keep(gap);
  for (const std::int64_t seq : excused_) {
    if (gap.has(seq)) fill(seq);
  }
}

void Sequence::keep(Gap gap) noexcept {
  missing_[oldest_] = gap;
  oldest_ = (oldest_ + 1) % missing_.size();
}

bool Sequence::is_missing(std::int64_t seq) const noexcept {
  return std::any_of(missing_.begin(), missing_.end(), [&](const Gap& g) { return g.has(seq); });
}

bool Sequence::fill(std::int64_t seq) noexcept {
  const auto gap =
      std::find_if(missing_.begin(), missing_.end(), [&](const Gap& g) { return g.has(seq); });
  if (gap == missing_.end()) return false;
  const Gap after{seq + 1, gap->to};
  gap->to = seq;
  if (gap->size() == 0) {
    *gap = after;
  } else if (after.size() > 0) {
    keep(after);
  }
  --counts_.lost;
  return true;
}

}  // namespace tauext
