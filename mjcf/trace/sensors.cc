// SPDX-License-Identifier: Apache-2.0
#include "mjcf/trace/sensors.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

namespace tauext {
namespace {

constexpr std::uint64_t kVelocity = 100;  // channel of the first joint's
constexpr double kSameTime = 1e-9;        // [s] what a sum of steps may be off

void check(const char* name, double value, double largest) {
  if (value >= 0 && value <= largest) return;
  throw std::invalid_argument(fmt::format("{} must be 0 to {:g}, not {}", name, largest, value));
}

// x / step may overflow where a step is smaller than any that a sensor could have
void check_step(const char* name, double step, double largest) {
  constexpr double kSmallest = 1e-12;
  check(name, step, largest);
  if (step == 0 || step >= kSmallest) return;
  throw std::invalid_argument(
      fmt::format("{} must be 0 for none, or {:g} or more, not {}", name, kSmallest, step));
}

void check(const Loadcell& l) {
  constexpr double kLargest = 1e6;
  check("loadcell scale [1]", l.scale, 1e3);
  check("loadcell |offset| [N]", std::abs(l.offset), kLargest);
  check("loadcell hysteresis [of full scale]", l.hysteresis, 1);
  check("loadcell |nonlinearity| [of full scale]", std::abs(l.nonlinearity), 1);
  check("loadcell noise [N]", l.noise, kLargest);
  check_step("loadcell step [N]", l.step, kLargest);
  check("loadcell full_scale [N]", l.full_scale, kLargest);
}

void check(const TorqueFaults& t) {
  check("torque gain [1]", t.gain, 0.9);
  check("torque hysteresis [1]", t.hysteresis, 10);
  check("torque ripple [1]", t.ripple, 10);
  check("torque waves [1]", t.waves, 1e5);
  check("torque bias [1]", t.bias, 10);
  check("torque noise [1]", t.noise, 10);
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

std::vector<Normals> velocity_noise(int dof, std::uint64_t seed) {
  std::vector<Normals> all;
  for (int j = 0; j < dof; ++j) all.emplace_back(seed, kVelocity + j);
  return all;
}

SensorStream::SensorStream(const Sensors& s, int dof, const std::vector<Screw>& screws,
                           const Eigen::VectorXd& usual_torque)
    : s_(s),
      screws_(screws),
      usual_(usual_torque),
      loop_(dof, std::nan("")),
      velocity_(generators(dof, s.seed, kVelocity)),
      torque_(generators(dof, s.seed, 200)),
      force_(generators(dof, s.seed, 300)),
      joint_(generators(dof, s.seed, 600)),
      clock_(s.seed, 400),
      line_(s.seed, 500),
      play_(dof, std::nan("")),
      stamp_(-std::numeric_limits<double>::infinity()) {
  // beyond these no arm is left to be seen
  check("velocity noise [rad/s]", s.velocity_noise, 1e9);
  check_step("encoder step [rad]", s.encoder_step, 1);
  check("loadcell noise [N m]", s.loadcell_noise, 1e5);
  check("latency [s]", s.latency, 1);
  check("tau_latency [s]", s.tau_latency, 1);
  check("jitter [s]", s.jitter, 1);
  check("dropped [1]", s.dropped, 0.99);
  check("repeated [1]", s.repeated, 0.99);
  check(s.loadcell);
  check(s.torque);
  if (!s.torque.ideal() && usual_.size() != dof)
    throw std::invalid_argument(
        "torque.gain and the like are shares of what each joint is used to, which is known of a "
        "simulated arm alone");
  for (int j = 0; j < dof && !s.torque.ideal(); ++j) {
    gain_.push_back(1 + joint_[j].uniform(-s.torque.gain, s.torque.gain));
    bias_.push_back(usual_[j] * joint_[j].uniform(-s.torque.bias, s.torque.bias));
    phase_.push_back(joint_[j].uniform(0, 2 * std::numbers::pi));
  }
  if (s_.loadcell.full_scale == 0) s_.loadcell.full_scale = screws.empty() ? 3000 : 1000;
}

SensorStream::SensorStream(const Sensors& s, const Trace& trace, std::vector<Normals>& drawn)
    : SensorStream(s, trace.dof(), trace.screws, trace.usual_torque) {
  drawn_ = &drawn;
}

double SensorStream::lever(int j, double q) const {
  return screws_.empty() ? 1 : screws_[j].lever(q);
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

// [N m]; q of the motor
double SensorStream::torque(int j, double true_torque, double q) {
  const TorqueFaults& t = s_.torque;
  const double half = t.hysteresis * usual_[j] / 2;
  double x = gain_[j] * true_torque;
  loop_[j] = std::isnan(loop_[j]) ? x : std::clamp(loop_[j], x - half, x + half);
  x = loop_[j] + bias_[j];
  if (t.ripple > 0) x += t.ripple * usual_[j] * std::sin(t.waves * q + phase_[j]);
  if (t.noise > 0) x += t.noise * usual_[j] * joint_[j].normal();
  return x;
}

void SensorStream::keep_past(const Sample& truth) {
  past_.push_back(truth);
  const double oldest = truth.t - s_.latency - s_.tau_latency;
  while (past_.size() > 1 && past_[1].t <= oldest + kSameTime) past_.pop_front();
}

// the last sample that is at least this old, or the oldest there is
const Sample& SensorStream::delayed(double by) const {
  const double until = past_.back().t - by + kSameTime;
  auto it = past_.rbegin();
  while (it + 1 != past_.rend() && it->t > until) ++it;
  return *it;
}

// into the reading, but for its time stamp
void SensorStream::take_values(const Sample& truth) {
  const bool late_at_all = s_.latency > 0 || s_.tau_latency > 0;
  if (late_at_all) keep_past(truth);
  Sample& y = reading_;
  y = late_at_all ? delayed(s_.latency) : truth;
  const Sample& late = late_at_all ? delayed(s_.latency + s_.tau_latency) : truth;
  for (int j = 0; j < y.q.size(); ++j) {
    y.tau[j] = late.tau[j];
    y.q[j] = rounded(y.q[j], s_.encoder_step);
    if (s_.velocity_noise > 0) {
      const double x = drawn_ == nullptr ? velocity_[j].normal() : (*drawn_)[j][samples_];
      y.qd[j] += s_.velocity_noise * x;
    }
    if (!(s_.loadcell.ideal() && s_.encoder_step == 0)) {
      y.tau[j] = force(j, y.tau[j] / lever(j, late.q[j])) * lever(j, y.q[j]);
    }
    if (!s_.torque.ideal()) y.tau[j] = torque(j, y.tau[j], late.q[j]);
    if (s_.loadcell_noise > 0) y.tau[j] += s_.loadcell_noise * torque_[j].normal();
  }
}

const Sample* SensorStream::read(const Sample& truth) {
  take_values(truth);
  ++samples_;
  Sample& y = reading_;
  y.t = truth.t;
  if (s_.jitter > 0) {
    y.t += clock_.uniform(-s_.jitter, s_.jitter);
    y.t = std::max(y.t, std::nextafter(stamp_, truth.t));  // never back in time
  }
  if (s_.repeated > 0 && line_.uniform() <= s_.repeated && last_.q.size() > 0) {
    y.q = last_.q, y.qd = last_.qd, y.tau = last_.tau;
  }
  if (s_.dropped > 0 && line_.uniform() <= s_.dropped) return nullptr;
  stamp_ = y.t;
  if (s_.repeated > 0) last_ = y;
  return &y;
}

namespace {

Trace measure(const Trace& truth, SensorStream stream) {
  Trace m = truth;
  m.motor_q.resize(0, 0), m.motor_qd.resize(0, 0);  // they are what is measured
  const Eigen::MatrixXd &q = truth.encoder_q(), &qd = truth.encoder_qd();
  std::vector<int> kept;
  Sample now;
  for (int k = 0; k < truth.size(); ++k) {
    now.t = truth.t[k];
    now.q = q.col(k), now.qd = qd.col(k), now.tau = truth.tau.col(k);
    const Sample* const y = stream.read(now);
    if (y == nullptr) continue;
    m.t[k] = y->t;
    m.q.col(k) = y->q;
    m.qd.col(k) = y->qd;
    m.tau.col(k) = y->tau;
    kept.push_back(k);
  }
  return static_cast<int>(kept.size()) == truth.size() ? m : select_samples(m, kept);
}

}  // namespace

Trace measure(const Trace& truth, const Sensors& s) {
  return measure(truth, SensorStream(s, truth.dof(), truth.screws, truth.usual_torque));
}

Trace measure(const Trace& truth, const Sensors& s, std::vector<Normals>& drawn) {
  return measure(truth, SensorStream(s, truth, drawn));
}

}  // namespace tauext
