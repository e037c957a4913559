// SPDX-License-Identifier: Apache-2.0
/// @file
/// What an arm lives through while its estimators are timed: it moves, rests, is pushed and hit,
/// and its sensors fail now and then. Nothing repeats, so no predictor learns it.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "estimators/types.h"

namespace tauext {

/// Numbers between 0 and 1 from Knuth's linear congruential generator: the same everywhere.
class LifeRandom {
 public:
  /// Others for each seed.
  explicit LifeRandom(unsigned seed) : state_(seed * 0x9e3779b97f4a7c15u + 1) { next(); }
  /// The next one.
  double next() {
    state_ = state_ * 6364136223846793005u + 1442695040888963407u;
    return static_cast<double>(state_ >> 11) * 0x1p-53;
  }
  /// The next one, between two others.
  double between(double low, double high) { return low + (high - low) * next(); }
  /// True once in so many times.
  bool one_in(int n) { return n * next() < 1; }

 private:
  std::uint64_t state_;
};

/// What a sensor may do.
enum class LifeFault { kNone, kNoTorque, kNoPosition, kWildSpeed, kOldTime, kCount };

/// One moment of it, as it is; `spoil` makes of it what the sensors say.
template <int N>
struct LifeMoment {
  Measurement<N> y;           ///< all but tau, which is the arm's to say
  Vec<N> qdd, tau_ext, load;  ///< [rad/s^2], [N m] true, [N m] as an estimator might say it
  LifeFault fault = LifeFault::kNone;  ///< of this sample
  int joint = 0;                       ///< that fails
  double old_time = 0;                 ///< [s] of the sample before

  /// To be called once tau is there.
  void spoil() {
    constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
    if (fault == LifeFault::kNoTorque) y.tau.setConstant(kNan);
    if (fault == LifeFault::kNoPosition) y.q[joint] = kNan;
    if (fault == LifeFault::kWildSpeed) y.qd[joint] = 1e3;
    if (fault == LifeFault::kOldTime) y.t = old_time;
  }
};

/// Moments 1 ms apart, in recordings that begin at t = 0: the first 30 % of the samples in
/// recordings of 1 to 4 s, the rest in one. In each, scenes of 0.2 to 1.5 s: rest, slow and brisk
/// motion, each with no load, a sine, a push (minimum jerk), blows of 30 ms, or a failure of the
/// torque sensor for 0.1 s. One sample of 100 is bad by itself (NaN, a speed of 1e3 rad/s, a time
/// stamp twice), and every 2,000th or so comes after a gap of 0.05 to 1 s.
template <int N>
class Life {
 public:
  /// Another one for each seed, of so many samples.
  Life(unsigned seed, int samples) : random_(seed), short_until_(samples * 3 / 10) {
    for (int j = 0; j < N; ++j) {
      for (int i = 0; i < kSines; ++i) {
        amplitude_[j][i] = random_.between(0.05, 0.25);
        frequency_[j][i] = random_.between(0.3, 3);
        phase_[j][i] = random_.between(0, 2 * kPi);
      }
    }
  }

  /// 1 ms later, or after a gap.
  LifeMoment<N> next() {
    if (k_ == recording_until_) begin_recording();
    if (k_ == scene_until_) begin_scene();
    LifeMoment<N> m = move();
    m.tau_ext = share_ * load(kStep * (k_ - scene_from_));
    for (int j = 0; j < N; ++j) {
      m.y.qd[j] += 3.46e-4 * (random_.next() - 0.5);
      m.load[j] = m.tau_ext[j] + random_.next() - 0.5;
    }
    m.y.t = t_;
    if (load_ == Load::kBlind && k_ - scene_from_ < 100) m.fault = LifeFault::kNoTorque;
    if (t_ > 0 && random_.one_in(100)) {
      m.fault = static_cast<LifeFault>(pick(static_cast<int>(LifeFault::kCount)));
      m.joint = pick(N);
      m.old_time = last_t_;
    }
    last_t_ = t_;
    t_ += random_.one_in(2000) ? random_.between(0.05, 1) : kStep;
    ++k_;
    return m;
  }

 private:
  enum class Load { kNone, kSine, kPush, kBlows, kBlind, kCount };
  static constexpr int kSines = 3;
  static constexpr double kStep = 1e-3, kPi = 3.141592653589793;

  void begin_recording() {
    t_ = 0;
    recording_until_ = k_ < short_until_ ? std::min(short_until_, k_ + 1000 + pick(3000))
                                         : std::numeric_limits<int>::max();
  }

  void begin_scene() {
    constexpr double kSpeeds[] = {0, 0.3, 1, 2.5};
    scene_from_ = k_;
    scene_until_ = k_ + 200 + pick(1300);
    wanted_speed_ = kSpeeds[pick(4)];
    load_ = static_cast<Load>(pick(static_cast<int>(Load::kCount)));
    blow_at_ = random_.between(0, 0.3);
    for (int j = 0; j < N; ++j) share_[j] = random_.between(-1, 1);
  }

  // along sums of sines, whose argument runs faster or slower
  LifeMoment<N> move() {
    constexpr double kSettling = 0.05;  // [s] of a change of speed
    const double change = (wanted_speed_ - speed_) / kSettling;
    speed_ += kStep * change;
    along_ += kStep * speed_;
    LifeMoment<N> m;
    for (int j = 0; j < N; ++j) {
      double q = 0, qd = 0, qdd = 0;
      for (int i = 0; i < kSines; ++i) {
        const double w = frequency_[j][i], x = w * along_ + phase_[j][i], a = amplitude_[j][i];
        q += a * std::sin(x);
        qd += a * w * std::cos(x) * speed_;
        qdd += a * w * (std::cos(x) * change - w * std::sin(x) * speed_ * speed_);
      }
      m.y.q[j] = q;
      m.y.qd[j] = qd;
      m.qdd[j] = qdd;
    }
    return m;
  }

  // [N m] so long after the scene's begin
  double load(double t) {
    if (load_ == Load::kSine) return 20 * std::sin(5 * t);
    if (load_ == Load::kPush) {
      const double s = std::min(1., t);
      return 60 * s * s * s * (10 - 15 * s + 6 * s * s);
    }
    if (load_ == Load::kBlows) {
      constexpr double kLength = 0.03;
      if (t > blow_at_ + kLength) blow_at_ = t + random_.between(0.05, 0.5);
      return t < blow_at_ ? 0 : 200 * std::sin(kPi / kLength * (t - blow_at_));
    }
    return 0;
  }

  int pick(int n) { return static_cast<int>(random_.between(0, n)); }

  LifeRandom random_;
  int k_ = 0, short_until_, recording_until_ = 0, scene_from_ = 0, scene_until_ = 0;
  double t_ = 0, last_t_ = 0, along_ = 0, speed_ = 0, wanted_speed_ = 0, blow_at_ = 0;
  Load load_ = Load::kNone;
  Vec<N> share_ = Vec<N>::Zero();
  double amplitude_[N][kSines], frequency_[N][kSines], phase_[N][kSines];
};

}  // namespace tauext
