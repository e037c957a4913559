// SPDX-License-Identifier: Apache-2.0
// Messages to test with.
#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "lcmtypes/emitter.h"

namespace tauext::test {

inline Reading reading(std::int64_t k, int n = 3) {
  Reading r;
  r.utime = 1000 * k;
  r.seq = k;
  r.t = 1e-3 * static_cast<double>(k);
  r.n = n;
  for (int j = 0; j < n; ++j) {
    r.q[j] = std::sin(r.t + j);
    r.qd[j] = std::cos(r.t + j);
    r.tau[j] = 10 * j + r.t;
    r.tau_ext[j] = 5 - j;
  }
  r.reference = ReferenceKind::kTruth;
  return r;
}

inline LiveSample live_sample(std::int64_t k, int stream = 0) {
  LiveSample s;
  s.reading = reading(k);
  s.tau_ext_hat = s.reading.tau_ext;
  s.stream = stream;
  return s;
}

template <class Message>
std::vector<std::byte> bytes_of(const Message& m) {
  std::vector<std::byte> bytes(m.getEncodedSize());
  bytes.resize(encode(m, bytes));
  return bytes;
}

// each of our types with something in it
inline summary_t summary() {
  summary_t m{};
  m.program = "tauext-bench";
  m.entry = "wallmobot3/step/ekf";
  m.n = 2;
  m.key = {"rmse_Nm", "max_Nm"};
  m.value = {6.4, 102};
  return m;
}
inline detection_t detection() {
  detection_t m{};
  m.utime = 5;
  m.mark = 1;
  m.score = 2.5;
  m.estimator = "ekf";
  m.detector = "pan_tompkins";
  return m;
}
inline force_t force() {
  force_t m{};
  m.utime = 7000;
  m.t = 7e-3;
  m.samples = 5;
  m.force[2] = -30;
  m.link = 4;
  m.estimator = "mo2";
  m.site = "end_effector";
  return m;
}
inline estimate_t estimate() {
  estimate_t m{};
  m.utime = 7000;
  m.t = 7e-3;
  m.n = 3;
  m.samples = 5;
  m.tau_ext_hat[2] = -98.2;
  return m;
}

// what a sink has got
struct Sent {
  std::string channel;
  std::int64_t utime;
  std::vector<std::byte> bytes;
};

template <class Message>
Message decoded(const Sent& s) {
  Message m{};
  if (decode(s.bytes, m) != Reject::kNone) m.utime = -1;
  return m;
}

}  // namespace tauext::test
