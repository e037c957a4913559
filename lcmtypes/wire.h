// SPDX-License-Identifier: Apache-2.0
/// @file
/// Bytes to messages and back. What comes from outside is checked before anything is decoded:
/// LCM's own decoders believe the lengths that a message claims.
///
/// The types themselves, with units and signs, are lcmtypes/*.lcm; lcm-gen makes structs of them,
/// whose members are uninitialised unless one writes `estimate_t e{}`.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "lcmtypes/detection_t.hpp"
#include "lcmtypes/estimate_t.hpp"
#include "lcmtypes/force_t.hpp"
#include "lcmtypes/iiwa_status_t.hpp"
#include "lcmtypes/panda_status_t.hpp"
#include "lcmtypes/sample_t.hpp"
#include "lcmtypes/summary_t.hpp"

namespace tauext {

/// The most joints that a message holds.
inline constexpr int kMaxJoints = 8;
/// The most metrics that a summary may hold.
inline constexpr int kMaxMetrics = 1000;
/// The longest of its texts [bytes].
inline constexpr int kMaxText = 4096;
/// The longest name of a channel [bytes], LCM_MAX_CHANNEL_NAME_LENGTH.
inline constexpr std::size_t kLongestChannel = 63;

/// Why a message was not decoded.
enum class Reject : std::uint8_t {
  kNone,        ///< it was
  kForeign,     ///< shorter than a hash, or the hash of another type
  kWrongSize,   ///< longer or shorter than its type and its counts say
  kWrongCount,  ///< a number of joints or metrics, or a length of a text, out of range
  /// a time or a message's number that is negative or beyond 2^53, or a t [s] that is not its utime
  /// [us]
  kWrongTime,
};

/// In words.
const char* describe(Reject reject) noexcept;

/// An encoded message.
using Bytes = std::span<const std::byte>;

/// The hash at the head of a message; 0 if it is shorter than that.
std::int64_t hash_of(Bytes message) noexcept;

/// When a message was sent, and its number, as its head says.
struct Stamp {
  std::int64_t utime = -1;  ///< [us]; -1: none
  std::int64_t seq = -1;    ///< [1] on its channel; -1: its type has none
};

/// The stamp of a message whose rest may be no good.
Stamp stamp_of(Bytes message) noexcept;

/// Decodes one of the types. `out` is untouched unless kNone comes back; numbers may still be
/// NaN.
template <class Message>
Reject decode(Bytes message, Message& out);

/// Encodes one of the types, whose vectors must be as long as their counts say; allocates
/// nothing.
/// @returns its size [bytes]; 0 if it does not fit
template <class Message>
std::size_t encode(const Message& message, std::span<std::byte> to) noexcept;

}  // namespace tauext
