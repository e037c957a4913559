// SPDX-License-Identifier: Apache-2.0
/// @file
/// What became of messages, from the numbers of those that came.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace tauext {

/// What a message's number says of it.
enum class Order : std::uint8_t {
  kNext,      ///< larger than all before
  kLate,      ///< overtaken: it was counted as lost until now
  kRepeated,  ///< it, or one like it, has come before
  kRestart,   ///< the sender has started anew
};

/// The numbers of one sender's messages, as they arrive: each is counted once, and the sum of all
/// counts is what was sent. Nothing that a single message claims is believed: a large jump counts
/// when the next message goes on from there, and numbers that go back are a sender that has started
/// anew once kPatience of them came in order, with nothing of the old stream between them.
class Sequence {
 public:
  static constexpr int kPatience = 20;  ///< messages

  /// Messages.
  struct Counts {
    std::int64_t next = 0, late = 0, repeated = 0;  ///< that came, by their Order
    std::int64_t lost = 0;                          ///< that never came
    std::int64_t foreign = 0;   ///< that jumped ahead, and the stream did not follow
    std::int64_t restarts = 0;  ///< of the sender
  };

  /// The number (0 to 2^53) of the next message that has come.
  Order take(std::int64_t seq) noexcept;

  /// A message of that number came and was no good: it is not lost.
  void excuse(std::int64_t seq) noexcept;

  /// The sender says that it has ended, and that its numbers ended before this one.
  void end(std::int64_t next) noexcept;

  /// The sender has started anew with this number.
  void restart(std::int64_t seq) noexcept;

  /// Whether the newest number is believed; one that jumped is once the next goes on from there.
  bool is_settled() const noexcept { return jump_.size() == 0; }

  const Counts& counts() const noexcept { return counts_; }  ///< since the begin

 private:
  // numbers from `from` to before `to`
  struct Gap {
    std::int64_t from = 0, to = 0;
    std::int64_t size() const { return to - from; }
    bool has(std::int64_t seq) const { return seq >= from && seq < to; }
  };
  static constexpr std::int64_t kSmall = 64;  // messages, which a network may have put in disorder
  static constexpr std::int64_t kNone = -1;

  Order take_ahead(std::int64_t seq) noexcept;
  Order take_behind(std::int64_t seq) noexcept;
  void settle_jump() noexcept;
  void refuse_jump() noexcept;
  void miss(Gap gap) noexcept;
  void keep(Gap gap) noexcept;
  bool is_missing(std::int64_t seq) const noexcept;
  bool fill(std::int64_t seq) noexcept;

  Counts counts_;
  bool any_ = false, ended_ = false;
  std::int64_t next_ = 0;
  Gap jump_;                     // not yet believed, if its size is not 0
  std::array<Gap, 64> missing_;  // the newest, of which one may still come
  std::size_t oldest_ = 0;
  std::array<std::int64_t, 64> excused_ = [] {
    std::array<std::int64_t, 64> none{};
    none.fill(kNone);
    return none;
  }();
  std::size_t oldest_excuse_ = 0;
  int behind_ = 0;       // in order, since the last that was next
  int behind_late_ = 0;  // of those, the late ones
  std::int64_t last_behind_ = 0;
};

}  // namespace tauext
