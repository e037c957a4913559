// SPDX-License-Identifier: Apache-2.0
/// @file
/// A measurement as it travels, whatever the type of the message that carries it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "lcmtypes/wire.h"

namespace tauext {

using Joints = std::array<double, kMaxJoints>;  ///< n values, zeros behind them

/// What a Reading's tau_ext is; the numbers of sample_t.
enum class ReferenceKind : std::int8_t {
  kNone = sample_t::kNone,
  kTruth = sample_t::kTruth,    ///< of a simulation
  kSender = sample_t::kSender,  ///< the sender's own estimate
};

/// One sample of an arm with n joints, in the signs of estimators/types.h.
struct Reading {
  std::int64_t utime = 0;  ///< [us]
  std::int64_t seq = -1;   ///< [1] number of the message on its channel; -1: its type has none
  double t = 0;            ///< [s] the same time as utime
  int n = 0;               ///< joints
  Joints q{};              ///< [rad]
  Joints qd{};             ///< [rad/s]
  Joints tau{};            ///< [N m] link side
  Joints tau_ext{};        ///< [N m] sign of (3), if there is a reference
  ReferenceKind reference = ReferenceKind::kNone;  ///< what tau_ext is
  bool contact = false;                            ///< a collision acts, as a simulation knows
};

/// Whether the n values are finite and below 10^6, which no torque [N m] is.
bool plausible(const Joints& torques, int n) noexcept;

/// Which messages a channel carries.
enum class MessageType : std::uint8_t {
  kTauext,  ///< sample_t, or estimate_t, which holds a measurement, too
  kIiwa,    ///< iiwa_status_t. tau = -joint_torque_measured, tau_ext = -joint_torque_external
  kPanda,   ///< panda_status_t. tau = joint_torque, tau_ext = joint_torque_external
};

/// "tauext", "iiwa" or "panda".
/// @throws std::invalid_argument for another name, listing these
MessageType message_type(std::string_view name);

/// The type whose hash a message bears; kNone of Reject if it carries a measurement.
Reject type_of(Bytes message, MessageType& type) noexcept;

/// Reads a message of that type. `out` is untouched unless kNone comes back.
Reject read(Bytes message, MessageType type, Reading& out);

/// Writes a message of that type (kTauext: sample_t); what the type has and a Reading has not is
/// zero.
/// @throws std::invalid_argument for a number of joints that is not 1 to 8
std::vector<std::byte> write(const Reading& reading, MessageType type);

}  // namespace tauext
