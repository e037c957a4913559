// SPDX-License-Identifier: Apache-2.0
#include "mjcf/sensors.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace tauext {
namespace {

void check(const char* name, double value, double largest) {
  if (value >= 0 && value <= largest) return;
  throw std::invalid_argument(fmt::format("{} must be 0 to {:g}, not {}", name, largest, value));
}

void check(const Loadcell& l) {
  constexpr double kLargest = 1e6;
  check("loadcell scale [1]", l.scale, 1e3);
  check("loadcell |offset| [N]", std::abs(l.offset), kLargest);
  check("loadcell hysteresis [of full scale]", l.hysteresis, 1);
  check("loadcell |nonlinearity| [of full scale]", std::abs(l.nonlinearity), 1);
  check("loadcell noise [N]", l.noise, kLargest);
  check("loadcell step [N]", l.step, kLargest);
  check("loadcell full_scale [N]", l.full_scale, kLargest);
  if (l.full_scale == 0) throw std::invalid_argument("loadcell full_scale [N] must be positive");
}

double rounded(double x, double step) {
  return step > 0 ? std::round(x / step) * step : x;
}

std::vector<Random> generators(int dof, std::uint64_t seed, std::uint64_t channel) {
  std::vector<Random> all;
  for (int j = 0; j < dof; ++j) all.emplace_back(seed, channel + j);
  return all;
}

}  // namespace

SensorStream::SensorStream(const Sensors& s, int dof, const std::vector<Screw>& screws)
    : s_(s),
      screws_(screws),
      velocity_(generators(dof, s.seed, 100)),
      torque_(generators(dof, s.seed, 200)),
      force_(generators(dof, s.seed, 300)),
      play_(dof, std::nan("")) {
  // beyond these no arm is left to be seen
  check("velocity noise [rad/s]", s.velocity_noise, 1e9);
  check("encoder step [rad]", s.encoder_step, 1);
  check("loadcell noise [N m]", s.loadcell_noise, 1e5);
  check(s.loadcell);
  if (!s.loadcell.ideal() && screws.empty()) {
    throw std::invalid_argument(
        "this robot has no screw whose loadcell could be degraded; --loadcell_noise [N m] acts on "
        "tau itself");
  }
}

double SensorStream::force(int j, double true_force) {
  const Loadcell& l = s_.loadcell;
  double f = l.scale * true_force + l.offset;
  // the reading is dragged along behind the force, half the loop's width away
  const double half = l.hysteresis * l.full_scale / 2;
  play_[j] = std::isnan(play_[j]) ? f : std::clamp(play_[j], f - half, f + half);
  f = play_[j];
  const double x = f / l.full_scale;
  f += l.nonlinearity * l.full_scale * 4 * x * (1 - std::abs(x));
  if (l.noise > 0) f += l.noise * force_[j].normal();
  return rounded(f, l.step);
}

Sample SensorStream::read(Sample y) {
  for (int j = 0; j < y.q.size(); ++j) {
    const double q = y.q[j];
    y.q[j] = rounded(q, s_.encoder_step);
    if (s_.velocity_noise > 0) y.qd[j] += s_.velocity_noise * velocity_[j].normal();
    if (!screws_.empty() && !(s_.loadcell.ideal() && s_.encoder_step == 0)) {
      y.tau[j] = force(j, y.tau[j] / screws_[j].lever(q)) * screws_[j].lever(y.q[j]);
    }
    if (s_.loadcell_noise > 0) y.tau[j] += s_.loadcell_noise * torque_[j].normal();
  }
  return y;
}

Trace measure(const Trace& truth, const Sensors& s) {
  SensorStream stream(s, truth.dof(), truth.screws);
  Trace m = truth;
  for (int k = 0; k < truth.size(); ++k) {
    const Sample y = stream.read({truth.t[k], truth.q.col(k), truth.qd.col(k), truth.tau.col(k)});
    m.q.col(k) = y.q;
    m.qd.col(k) = y.qd;
    m.tau.col(k) = y.tau;
  }
  return m;
}

}  // namespace tauext
