// SPDX-License-Identifier: Apache-2.0
#include "lcmtypes/reading.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace tauext {
namespace {

template <class From>
Joints joints(const From& from, int n, double sign = 1) {
  Joints out{};
  for (int j = 0; j < n; ++j) out[j] = sign * from[j];
  return out;
}

std::vector<double> values(const Joints& from, int n, double sign = 1) {
  std::vector<double> out(n);
  for (int j = 0; j < n; ++j) out[j] = sign * from[j];
  return out;
}

template <class Message>
Reading of_tauext(const Message& m) {
  Reading r{m.utime, m.seq, m.t, m.n};
  r.q = joints(m.q, m.n);
  r.qd = joints(m.qd, m.n);
  r.tau = joints(m.tau, m.n);
  r.tau_ext = joints(m.tau_ext_true, m.n);
  const bool known = m.reference == sample_t::kTruth || m.reference == sample_t::kSender;
  r.reference = known ? static_cast<ReferenceKind>(m.reference) : ReferenceKind::kNone;
  return r;
}

Reading reading_of(const estimate_t& m) {
  return of_tauext(m);
}

Reading reading_of(const sample_t& m) {
  Reading r = of_tauext(m);
  r.contact = m.contact != 0;
  return r;
}

Reading reading_of(const iiwa_status_t& m) {
  const int n = m.num_joints;
  Reading r{m.utime, -1, static_cast<double>(m.utime) / 1e6, n};
  r.q = joints(m.joint_position_measured, n);
  r.qd = joints(m.joint_velocity_estimated, n);
  r.tau = joints(m.joint_torque_measured, n, -1);
  r.tau_ext = joints(m.joint_torque_external, n, -1);
  r.reference = ReferenceKind::kSender;
  return r;
}

Reading reading_of(const panda_status_t& m) {
  const int n = m.num_joints;
  Reading r{m.utime, -1, static_cast<double>(m.utime) / 1e6, n};
  r.q = joints(m.joint_position, n);
  r.qd = joints(m.joint_velocity, n);
  r.tau = joints(m.joint_torque, n);
  r.tau_ext = joints(m.joint_torque_external, n);
  r.reference = ReferenceKind::kSender;
  return r;
}

template <class Message>
Reject read_as(Bytes bytes, Reading& out) {
  Message m{};
  const Reject reject = decode(bytes, m);
  if (reject == Reject::kNone) out = reading_of(m);
  return reject;
}

template <class Message>
std::vector<std::byte> encoded(const Message& m) {
  std::vector<std::byte> bytes(m.getEncodedSize());
  bytes.resize(encode(m, bytes));
  return bytes;
}

sample_t sample_of(const Reading& r) {
  sample_t m{};
  m.utime = r.utime;
  m.seq = std::max<std::int64_t>(r.seq, 0);
  m.t = r.t;
  m.n = r.n;
  m.reference = static_cast<std::int8_t>(r.reference);
  m.contact = r.contact;
  std::copy(r.q.begin(), r.q.end(), m.q);
  std::copy(r.qd.begin(), r.qd.end(), m.qd);
  std::copy(r.tau.begin(), r.tau.end(), m.tau);
  std::copy(r.tau_ext.begin(), r.tau_ext.end(), m.tau_ext_true);
  return m;
}

iiwa_status_t iiwa_of(const Reading& r) {
  const std::vector<double> q = values(r.q, r.n), tau = values(r.tau, r.n);
  iiwa_status_t m{};
  m.utime = r.utime;
  m.num_joints = r.n;
  m.joint_position_measured = m.joint_position_commanded = m.joint_position_ipo = q;
  m.joint_velocity_estimated = values(r.qd, r.n);
  m.joint_torque_measured = values(r.tau, r.n, -1);
  m.joint_torque_commanded = tau;
  m.joint_torque_external = values(r.tau_ext, r.n, -1);
  return m;
}

panda_status_t panda_of(const Reading& r) {
  panda_status_t m{};
  m.utime = m.robot_utime = r.utime;
  m.num_joints = r.n;
  m.joint_position = m.joint_position_desired = values(r.q, r.n);
  m.joint_velocity = m.joint_velocity_desired = values(r.qd, r.n);
  m.joint_acceleration_desired.resize(r.n);
  m.joint_torque = m.joint_torque_desired = values(r.tau, r.n);
  m.joint_torque_external = values(r.tau_ext, r.n);
  return m;
}

}  // namespace

bool plausible(const Joints& torques, int n) noexcept {
  constexpr double kLimit = 1e6;  // [N m]
  return std::all_of(torques.begin(), torques.begin() + n,
                     [](double x) { return std::abs(x) < kLimit; });
}

MessageType message_type(std::string_view name) {
  if (name == "tauext") return MessageType::kTauext;
  if (name == "iiwa") return MessageType::kIiwa;
  if (name == "panda") return MessageType::kPanda;
  throw std::invalid_argument(
      fmt::format("unknown type of message '{}'; known: tauext, iiwa, panda", name));
}

Reject type_of(Bytes message, MessageType& type) noexcept {
  const std::int64_t hash = hash_of(message);
  if (hash == sample_t::getHash() || hash == estimate_t::getHash()) {
    type = MessageType::kTauext;
  } else if (hash == iiwa_status_t::getHash()) {
    type = MessageType::kIiwa;
  } else if (hash == panda_status_t::getHash()) {
    type = MessageType::kPanda;
  } else {
    return Reject::kForeign;
  }
  return Reject::kNone;
}

Reject read(Bytes message, MessageType type, Reading& out) {
  switch (type) {
    case MessageType::kTauext:
      return hash_of(message) == estimate_t::getHash() ? read_as<estimate_t>(message, out)
                                                       : read_as<sample_t>(message, out);
    case MessageType::kIiwa:
      return read_as<iiwa_status_t>(message, out);
    case MessageType::kPanda:
      return read_as<panda_status_t>(message, out);
  }
  return Reject::kForeign;
}

std::vector<std::byte> write(const Reading& r, MessageType type) {
  if (r.n < 1 || r.n > kMaxJoints) {
    throw std::invalid_argument(fmt::format("{} joints: a message holds 1 to {}", r.n, kMaxJoints));
  }
  if (type == MessageType::kIiwa) return encoded(iiwa_of(r));
  if (type == MessageType::kPanda) return encoded(panda_of(r));
  return encoded(sample_of(r));
}

}  // namespace tauext
