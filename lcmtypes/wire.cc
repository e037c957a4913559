// SPDX-License-Identifier: Apache-2.0
#include "lcmtypes/wire.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "mjcf/trace/byte_order.h"

namespace tauext {
namespace {

// walks over a message without believing it
class Cursor {
 public:
  explicit Cursor(Bytes rest) : rest_(rest) {}

  std::uint64_t number(std::size_t size) {
    const Bytes bytes = take(size);
    return from_bytes(bytes.data(), bytes.size(), std::endian::big);
  }
  void skip(std::size_t bytes) { take(bytes); }

  // a time or a number, whose differences and sums cannot overflow
  std::int64_t time() {
    constexpr std::uint64_t kLargest = std::uint64_t{1} << 53;
    const std::uint64_t value = number(8);
    if (value > kLargest) reject(Reject::kWrongTime);
    return static_cast<std::int64_t>(value);
  }
  // t [s], which says the same as the utime [us] before it
  void same_time_in_seconds(std::int64_t utime) {
    const double t = std::bit_cast<double>(number(8));
    constexpr double kRounding = 1e-5;  // [s]
    if (!(std::abs(t - static_cast<double>(utime) * 1e-6) <= kRounding)) {
      reject(Reject::kWrongTime);
    }
  }

  // a count that the message claims
  std::int32_t count(std::int32_t least, std::int32_t most) {
    const auto n = static_cast<std::int32_t>(number(4));
    if (n < least || n > most) reject(Reject::kWrongCount);
    return reject_ == Reject::kNone ? n : 0;
  }
  void text() {  // its length counts a final 0
    const Bytes t = take(static_cast<std::size_t>(count(1, kMaxText)));
    // and that is its only one
    if (reject_ == Reject::kNone && std::find(t.begin(), t.end(), std::byte{0}) != t.end() - 1) {
      reject_ = Reject::kWrongCount;
    }
  }
  Reject finish() {
    if (!rest_.empty()) reject(Reject::kWrongSize);
    return reject_;
  }

 private:
  Bytes take(std::size_t bytes) {
    if (bytes > rest_.size()) reject(Reject::kWrongSize);
    if (reject_ != Reject::kNone) return {};
    const Bytes taken = rest_.first(bytes);
    rest_ = rest_.subspan(bytes);
    return taken;
  }

  // the first reason stays
  void reject(Reject why) {
    if (reject_ == Reject::kNone) reject_ = why;
  }

  Bytes rest_;
  Reject reject_ = Reject::kNone;
};

// what the body must look like, type by type

void walk(Cursor& c, const sample_t&) {
  const std::int64_t utime = c.time();
  c.time();  // seq
  c.same_time_in_seconds(utime);
  c.count(1, kMaxJoints);
  c.skip(2 + 4 * kMaxJoints * 8);
}

void walk(Cursor& c, const estimate_t&) {
  const std::int64_t utime = c.time();
  c.time();  // seq
  c.same_time_in_seconds(utime);
  c.count(1, kMaxJoints);
  c.skip(4 + 2 + (9 * kMaxJoints + 1) * 8);
}

void walk(Cursor& c, const force_t&) {
  const std::int64_t utime = c.time();
  c.time();  // seq
  c.same_time_in_seconds(utime);
  c.skip(4 + (3 + 3 + 6 + 1 + 1) * 8);
  c.count(0, kMaxJoints);  // link
  c.skip((3 + 3) * 8);
  c.text();
  c.text();
}

void walk(Cursor& c, const detection_t&) {
  c.time();
  c.time();  // seq
  c.skip(4 + 1);
  c.time();  // of the mark
  c.skip(2 + 8);
  c.text();
  c.text();
}

void walk(Cursor& c, const summary_t&) {
  c.time();
  for (int i = 0; i < 3; ++i) c.text();
  c.skip(2 * 8);
  for (int i = 0; i < 6; ++i) c.time();  // counts
  const int n = c.count(0, kMaxMetrics);
  for (int i = 0; i < n; ++i) c.text();
  c.skip(static_cast<std::size_t>(n) * 8);
}

void walk(Cursor& c, const iiwa_status_t&) {
  c.time();
  c.skip(static_cast<std::size_t>(c.count(1, kMaxJoints)) * 7 * 8);
}

void walk(Cursor& c, const panda_status_t&) {
  c.time();
  c.skip(static_cast<std::size_t>(c.count(1, kMaxJoints)) * 8 * 8);
  c.skip(8 + 1 + 8 + 1);
}

}  // namespace

const char* describe(Reject reject) noexcept {
  switch (reject) {
    case Reject::kNone:
      return "good";
    case Reject::kForeign:
      return "of another type";
    case Reject::kWrongSize:
      return "of a wrong size";
    case Reject::kWrongCount:
      return "with an impossible count or length";
    case Reject::kWrongTime:
      return "with an impossible time or number";
  }
  return "?";
}

std::int64_t hash_of(Bytes message) noexcept {
  return message.size() < 8 ? 0 : static_cast<std::int64_t>(Cursor(message).number(8));
}

Stamp stamp_of(Bytes message) noexcept {
  const std::int64_t hash = hash_of(message);
  const bool numbered = hash == sample_t::getHash() || hash == estimate_t::getHash() ||
                        hash == detection_t::getHash() || hash == force_t::getHash();
  const bool timed =
      numbered || hash == iiwa_status_t::getHash() || hash == panda_status_t::getHash();
  const std::size_t size = numbered ? 24 : 16;
  if (!timed || message.size() < size) return {};
  Cursor c(message.first(size).subspan(8));
  Stamp stamp;
  stamp.utime = c.time();
  if (numbered) stamp.seq = c.time();
  return c.finish() == Reject::kNone ? stamp : Stamp{};
}

template <class Message>
Reject decode(Bytes message, Message& out) {
  if (message.size() < 8 || hash_of(message) != Message::getHash()) return Reject::kForeign;
  Cursor c(message.subspan(8));
  walk(c, out);
  if (const Reject reject = c.finish(); reject != Reject::kNone) return reject;
  const int size = static_cast<int>(message.size());
  return out.decode(message.data(), 0, size) == size ? Reject::kNone : Reject::kWrongSize;
}

template <class Message>
std::size_t encode(const Message& message, std::span<std::byte> to) noexcept {
  const int size = message.encode(to.data(), 0, static_cast<int>(to.size()));
  return static_cast<std::size_t>(std::max(size, 0));
}

// lcm-gen declares constants without defining them: whoever takes a reference to one needs it here
const std::int8_t sample_t::kNone;
const std::int8_t sample_t::kTruth;
const std::int8_t sample_t::kSender;
const std::int8_t estimate_t::kNone;
const std::int8_t estimate_t::kTruth;
const std::int8_t estimate_t::kSender;
const std::int8_t estimate_t::kOk;
const std::int8_t estimate_t::kStarted;
const std::int8_t estimate_t::kBadMeasurement;
const std::int8_t estimate_t::kSingularInertia;
const std::int8_t estimate_t::kDiverged;
const std::int8_t estimate_t::kBadTime;
const std::int8_t estimate_t::kOutOfRange;
const std::int8_t estimate_t::kJump;
const std::int8_t estimate_t::kFrozen;
const std::int8_t estimate_t::kUnlikely;
const std::int8_t detection_t::kNone;
const std::int8_t detection_t::kIntentional;
const std::int8_t detection_t::kCollision;
const std::int8_t detection_t::kClamping;
const std::int8_t panda_status_t::kOther;
const std::int8_t panda_status_t::kIdle;
const std::int8_t panda_status_t::kMove;
const std::int8_t panda_status_t::kGuiding;
const std::int8_t panda_status_t::kReflex;
const std::int8_t panda_status_t::kUserStopped;
const std::int8_t panda_status_t::kAutomaticErrorRecovery;
const std::int8_t panda_status_t::kPosition;
const std::int8_t panda_status_t::kVelocity;
const std::int8_t panda_status_t::kTorque;

template Reject decode(Bytes, sample_t&);
template Reject decode(Bytes, estimate_t&);
template Reject decode(Bytes, force_t&);
template Reject decode(Bytes, detection_t&);
template Reject decode(Bytes, summary_t&);
template Reject decode(Bytes, iiwa_status_t&);
template Reject decode(Bytes, panda_status_t&);
template std::size_t encode(const sample_t&, std::span<std::byte>) noexcept;
template std::size_t encode(const estimate_t&, std::span<std::byte>) noexcept;
template std::size_t encode(const force_t&, std::span<std::byte>) noexcept;
template std::size_t encode(const detection_t&, std::span<std::byte>) noexcept;
template std::size_t encode(const summary_t&, std::span<std::byte>) noexcept;
template std::size_t encode(const iiwa_status_t&, std::span<std::byte>) noexcept;
template std::size_t encode(const panda_status_t&, std::span<std::byte>) noexcept;

}  // namespace tauext
