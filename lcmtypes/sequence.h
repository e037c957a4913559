// SPDX-License-Identifier: Apache-2.0
/// @file
/// How many messages never came, from the numbers of those that did.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

namespace tauext {

/// The numbers of one sender's messages, as they arrive. One that comes late after all is no loss.
/// A number that goes back is late, or another sender's on the same channel; only kPatience of them
/// in order, with nothing of the old stream between them, are a sender that has started anew.
class Sequence {
 public:
  static constexpr int kPatience = 20;  ///< messages
  /// Messages: a larger jump is another sender, or one that was away for long, and no loss.
  static constexpr std::int64_t kLargestLoss = 10'000;

  /// The number of the next message that has come.
  void take(std::int64_t seq) noexcept {
    if (!any_ || seq >= next_) {
      if (any_) miss(next_, seq);
      advance(seq);
    } else if (const auto it = std::find(missing_.begin(), missing_.end(), seq);
               it != missing_.end()) {
      *it = kNone;
      --lost_;
    } else {
      ++strays_;
      behind_ = behind_ > 0 && seq > last_behind_ ? behind_ + 1 : 1;
      last_behind_ = seq;
      if (behind_ >= kPatience) restart(seq);
    }
  }

  /// The sender has started anew with this number.
  void restart(std::int64_t seq) noexcept {
    missing_.fill(kNone);
    advance(seq);
  }

  std::int64_t lost() const noexcept { return lost_; }  ///< messages
  /// Numbers that were neither next nor missing: copies, or another sender's.
  std::int64_t strays() const noexcept { return strays_; }

 private:
  static constexpr std::int64_t kNone = -1;

  void miss(std::int64_t from, std::int64_t to) noexcept {
    const std::int64_t count = to - from;
    if (count > kLargestLoss) return;
    lost_ += count;
    const auto kept = static_cast<std::int64_t>(missing_.size());
    for (std::int64_t seq = std::max(from, to - kept); seq < to; ++seq) {
      missing_[oldest_] = seq;
      oldest_ = (oldest_ + 1) % missing_.size();
    }
  }
  void advance(std::int64_t seq) noexcept {
    any_ = true;
    next_ = seq + 1;
    behind_ = 0;
  }

  bool any_ = false;
  std::int64_t next_ = 0, lost_ = 0, strays_ = 0, last_behind_ = 0;
  int behind_ = 0;
  std::array<std::int64_t, 64> missing_ = [] {
    std::array<std::int64_t, 64> none{};
    none.fill(kNone);
    return none;
  }();  // the newest that may still come
  std::size_t oldest_ = 0;
};

}  // namespace tauext
