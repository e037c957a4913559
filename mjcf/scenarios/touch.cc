// SPDX-License-Identifier: Apache-2.0
#include "mjcf/scenarios/touch.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "mjcf/plant/plant.h"
#include "mjcf/scenarios/motion.h"
#include "mjcf/trace/random.h"

namespace tauext {
namespace {

using Eigen::Vector3d;
constexpr double kPi = std::numbers::pi;

// 0 to 1 as x goes from 0 to 1
double minimum_jerk(double x) {
  return reference_at(MinimumJerk{.begin = 0, .duration = 1, .from = 0, .to = 1}, x).q;
}

Touch draw(TouchKind kind, double begin, Random& random) {
  Touch t{.kind = kind, .begin = begin};
  double size = 0;
  switch (kind) {
    case TouchKind::kBlow:
      size = random.uniform(100, 300);
      t.rise = random.uniform(0.01, 0.05);
      break;
    case TouchKind::kSlowPush:
      size = random.uniform(30, 80);
      t.rise = random.uniform(0.8, 2);
      t.hold = random.uniform(0, 1);
      t.fall = random.uniform(0.8, 2);
      break;
    case TouchKind::kBriskPush:
      size = 100;
      t.rise = 0.1;
      t.hold = random.uniform(0.2, 0.5);
      t.fall = 0.3;
      break;
    case TouchKind::kClamp:
      size = 200;
      t.rise = random.uniform(0.5, 1);
      t.hold = 2;
      t.fall = 0.5;
      break;
  }
  const double direction = random.uniform(0, 2 * kPi);
  t.force = size * Vector3d(std::cos(direction), 0, std::sin(direction));
  return t;
}

}  // namespace

Vector3d Touch::operator()(double t) const {
  if (!on(t)) return Vector3d::Zero();
  const double since = t - begin;
  if (kind == TouchKind::kBlow) return force * std::sin(kPi * since / rise);
  const double way = since < rise ? since / rise : since < rise + hold ? 1 : (end() - t) / fall;
  return force * (kind == TouchKind::kClamp ? way : minimum_jerk(way));
}

std::vector<Touch> draw_touches(TouchKind kind, std::uint64_t seed, double from, double until) {
  Random random(seed, 1000 + static_cast<std::uint64_t>(kind));
  const double pause = kind == TouchKind::kClamp ? 2 : 1;  // [s]
  std::vector<Touch> all;
  for (double t = from;;) {
    const Touch next = draw(kind, t + random.uniform(0, 1), random);
    t = next.end() + pause;
    if (t > until) return all;
    all.push_back(next);
  }
}

Scenario with_touches(Scenario s, const std::vector<Touch>& touches) {
  s.force = [=](double t, const Point&) -> Vector3d {
    Vector3d sum = Vector3d::Zero();
    for (const Touch& touch : touches) sum += touch(t);
    return sum;
  };
  s.contact = [=](double t, const Point&) {
    for (const Touch& touch : touches) {
      const bool counts = touch.kind == TouchKind::kBlow || touch.kind == TouchKind::kClamp;
      if (counts && touch.on(t)) return true;
    }
    return false;
  };
  return s;
}

std::vector<Touch> touches_of_wallmobot3(TouchKind kind, std::uint64_t seed) {
  return draw_touches(kind, seed, kFirstTouch, quiet().duration);
}

namespace {

constexpr double kMostSpeed = 2, kMostAcceleration = 10;  // [rad/s], [rad/s^2]

struct TwoSines {
  double middle, A[2], w[2], phase[2];

  Reference operator()(double t) const {
    Reference r{middle, 0, 0};
    for (int i = 0; i < 2; ++i) {
      const double at = w[i] * t + phase[i];
      r.q += A[i] * std::sin(at);
      r.qd += A[i] * w[i] * std::cos(at);
      r.qdd -= A[i] * w[i] * w[i] * std::sin(at);
    }
    return r;
  }
};

std::vector<TwoSines> drawn_sines(const Eigen::VectorXd& home, const Eigen::VectorXd& reach,
                                  Random& random) {
  std::vector<TwoSines> all;
  for (Eigen::Index i = 0; i < home.size(); ++i) {
    const double most = std::min(kMostSpeed / reach[i], std::sqrt(kMostAcceleration / reach[i]));
    TwoSines s{.middle = home[i], .A = {0.6 * reach[i], 0.4 * reach[i]}, .w = {}, .phase = {}};
    for (int k = 0; k < 2; ++k) {
      s.w[k] = random.uniform(0.15, 1) * most;
      s.phase[k] = random.uniform(0, 2 * std::numbers::pi);
    }
    all.push_back(s);
  }
  return all;
}

// @param move of a joint that goes from there to there at t, at that speed where it goes `way`
template <class Move, class Make>
std::vector<Moves<Move>> drawn_moves(const Eigen::VectorXd& home, const Eigen::VectorXd& reach,
                                     Random& random, Make&& move) {
  std::vector<std::vector<Move>> moves(static_cast<std::size_t>(home.size()));
  Eigen::VectorXd at = home;
  for (double t = 0; t < quiet().duration;) {
    Eigen::VectorXd to = home;
    for (Eigen::Index i = 0; i < to.size(); ++i) to[i] += reach[i] * random.uniform(-1, 1);
    const double way = (to - at).cwiseAbs().maxCoeff(), speed = random.uniform(0.5, kMostSpeed);
    double longest = 0;  // [s]
    for (std::size_t i = 0; i < moves.size(); ++i) {
      const auto k = static_cast<Eigen::Index>(i);
      const auto [of_joint, duration] = move(t, at[k], to[k], way, speed);
      moves[i].push_back(of_joint);
      longest = std::max(longest, duration);
    }
    at = to;
    t += longest + random.uniform(0.2, 1);
  }
  return {moves.begin(), moves.end()};
}

std::pair<MinimumJerk, double> as_a_hand(double t, double from, double to, double way,
                                         double speed) {
  constexpr double kSpeed = 1.875, kAcceleration = 5.78;  // of minimum jerk: largest, of d / T^n
  const double T =
      std::max(kSpeed * way / speed, std::sqrt(kAcceleration * way / kMostAcceleration));
  return {{.begin = t, .duration = T, .from = from, .to = to}, T};
}

// from rest to rest with a sine of acceleration, as cams do
struct Cycloid {
  double begin, duration, from, to;
};

Reference reference_at(const Cycloid& m, double t) {
  const double turn = 2 * std::numbers::pi, way = m.to - m.from;
  const double share = std::clamp((t - m.begin) / m.duration, 0., 1.), at = turn * share;
  if (share == 0 || share == 1) return {m.from + share * way, 0, 0};
  return {m.from + way * (share - std::sin(at) / turn), way / m.duration * (1 - std::cos(at)),
          way / (m.duration * m.duration) * turn * std::sin(at)};
}

std::pair<Cycloid, double> as_a_cam(double t, double from, double to, double way, double speed) {
  const double T =
      std::max(2 * way / speed, std::sqrt(2 * std::numbers::pi * way / kMostAcceleration));
  return {{t, T, from, to}, T};
}

}  // namespace

std::function<Reference(double, int)> brisk_motion(const Eigen::VectorXd& home,
                                                   const Eigen::VectorXd& reach, std::uint64_t seed,
                                                   bool training) {
  Random random(seed, 997);
  const auto of_joint = [](auto all) {
    return [all](double t, int i) { return all[static_cast<std::size_t>(i)](t); };
  };
  if (!training) return of_joint(drawn_moves<MinimumJerk>(home, reach, random, as_a_hand));
  if (seed % 2 == 0) return of_joint(drawn_sines(home, reach, random));
  return of_joint(drawn_moves<Cycloid>(home, reach, random, as_a_cam));
}

Scenario touched_wallmobot3(TouchKind kind, std::uint64_t seed) {
  Random random(seed, 999);
  const double amplitude = random.uniform(0.05, 0.1), w = random.uniform(0.5, 1);
  Scenario s = quiet();
  s.name = "touched";
  s.description = "drawn touches of one kind";
  s.response = Response::kDetection;
  s.reference = [=](double t, int) { return sine_motion(amplitude, w, t); };
  return with_touches(s, touches_of_wallmobot3(kind, seed));
}

}  // namespace tauext
