// SPDX-License-Identifier: Apache-2.0
#include "mjcf/scenarios/motion.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace tauext {

Reference sine_motion(double amplitude, double w, double t) {
  return {amplitude * std::sin(w * t), amplitude * w * std::cos(w * t),
          -amplitude * w * w * std::sin(w * t)};
}

double paper_sine(double t) {
  return 10 * std::sin(t) + 5 * std::cos(2 * t + std::numbers::pi / 2) - 5;
}

double swept_sine(double t, double from, double to) {
  constexpr double kFade = 1;                       // [s]
  constexpr double kSlowest = 0.5, kFastest = 300;  // [rad/s]
  if (t < from || t >= to) return 0;
  const double octaves = std::log(kFastest / kSlowest), duration = to - from;
  const double phase = kSlowest * duration / octaves * std::expm1(octaves * (t - from) / duration);
  const double edge = std::min({1., (t - from) / kFade, (to - t) / kFade});
  return 0.5 * (1 - std::cos(std::numbers::pi * edge)) * std::sin(phase);
}

Reference reference_at(const MinimumJerk& m, double t) {
  const double T = m.duration, s = std::clamp((t - m.begin) / T, 0., 1.), d = m.to - m.from;
  if (s == 0 || s == 1) return {s == 0 ? m.from : m.to, 0, 0};
  return {m.from + d * s * s * s * (10 - 15 * s + 6 * s * s),
          d / T * 30 * s * s * (1 - s) * (1 - s), d / (T * T) * 60 * s * (1 - 3 * s + 2 * s * s)};
}

double Trapezium::duration() const {
  const double way = std::abs(to - from);
  // without a plateau if the way is short
  if (way < speed * speed / acceleration) return 2 * std::sqrt(way / acceleration);
  return way / speed + speed / acceleration;
}

Reference reference_at(const Trapezium& m, double t) {
  const double T = m.duration(), s = t - m.begin, sense = m.to < m.from ? -1 : 1;
  if (s <= 0) return {m.from, 0, 0};
  if (s >= T) return {m.to, 0, 0};
  const double ramp = std::min(m.speed / m.acceleration, T / 2), top = m.acceleration * ramp;
  const double left = T - s;
  if (s < ramp) {
    return {m.from + sense * m.acceleration * s * s / 2, sense * m.acceleration * s,
            sense * m.acceleration};
  }
  if (left < ramp) {
    return {m.to - sense * m.acceleration * left * left / 2, sense * m.acceleration * left,
            -sense * m.acceleration};
  }
  return {m.from + sense * top * (s - ramp / 2), sense * top, 0};
}

}  // namespace tauext
