// SPDX-License-Identifier: Apache-2.0
// Section 6 of the paper: the experiments of Figs. 10 to 15. What the paper leaves open (speeds,
// limits, the human's hand, the obstacle) is ours.
#include "mjcf/scenarios/testbed1.h"

#include <cmath>
#include <numbers>
#include <utility>

#include "mjcf/plant/plant.h"
#include "mjcf/scenarios/motion.h"
#include "mjcf/trace/random.h"

namespace tauext {
namespace {

using Eigen::Vector3d;

constexpr double kLower = -0.4, kUpper = 0.6;          // [rad] limits of the arm
constexpr double kHold = 0.5;                          // [rad] of section 6.2
constexpr double kArm = 0.7, kHingeHeight = 1.0;       // [m] of testbed1.xml
constexpr Tracking kScrewDrive{.Kp = 4e4, .Kd = 400};  // a position-controlled screw is stiff

// the up and the down button: a press drives the arm to that limit, where it stops; it has to have
// stopped before the next press
enum class Button { kUp, kDown };
struct Press {
  double t;  // [s]
  Button button;
};

Moves<Trapezium> buttons(double start, const std::vector<Press>& presses, double speed) {
  std::vector<Trapezium> moves;
  double q = start;
  for (const Press& p : presses) {
    const double to = p.button == Button::kUp ? kUpper : kLower;
    moves.push_back({.begin = p.t, .from = q, .to = to, .speed = speed, .acceleration = 2});
    q = to;
  }
  return Moves<Trapezium>(moves);
}

// a human's hand at the tip: it moves with minimum jerk, and pulls the arm along as a soft spring
// and damper (the stiffness and viscosity of a relaxed human arm)
struct Hand {
  static constexpr double kStiffness = 400, kViscosity = 40;  // [N/m], [N s/m]
  Moves<MinimumJerk> height;                                  // [m]

  Vector3d operator()(double t, const Point& tip) const {
    const Reference hand = height(t);
    return {0, 0,
            kStiffness * (hand.q - tip.position.z()) + kViscosity * (hand.qd - tip.velocity.z())};
  }
};

double tip_height(double q) {
  return kHingeHeight + kArm * std::sin(q);
}

Hand random_hand(std::uint64_t seed, double until) {
  Random random(seed);
  std::vector<MinimumJerk> moves;
  double t = 1, z = tip_height(0);
  while (t < until) {
    const double to = tip_height(random.uniform(kLower, kUpper));
    const double duration = random.uniform(0.8, 2.5);
    moves.push_back({t, duration, z, to});
    z = to;
    t += duration + random.uniform(0, 1);
  }
  return {Moves<MinimumJerk>(moves)};
}

// a push that changes all the time, near the pendulum's own 4.7 rad/s, to swing it in both planes
std::function<Vector3d(double)> random_swing(double from, double until) {
  Random random(13);
  struct Tone {
    double w, phase, x, y;
  };
  std::vector<Tone> tones;
  for (int i = 0; i < 6; ++i) {
    tones.push_back({random.uniform(2, 8), random.uniform(0, 2 * std::numbers::pi),
                     random.uniform(-1, 1), random.uniform(-1, 1)});
  }
  return [=](double t) -> Vector3d {
    Vector3d f = Vector3d::Zero();
    if (t < from || t >= until) return f;
    for (const Tone& tone : tones) {
      f += 0.8 * std::sin(tone.w * (t - from) + tone.phase) * Vector3d(tone.x, tone.y, 0);
    }
    return f;
  };
}

Scenario base(const char* name, const char* description) {
  Scenario s = quiet();
  s.name = name;
  s.description = description;
  s.start_on_reference = true;
  s.tracking = kScrewDrive;
  return s;
}

Scenario hold(const char* name, const char* description) {
  Scenario s = base(name, description);
  s.duration = 40;
  s.response = Response::kStep;
  s.reference = [](double, int) { return Reference{kHold, 0, 0}; };
  s.scene = "load";
  return s;
}

}  // namespace

Scenario manual_of_testbed1(std::uint64_t seed) {
  Scenario s = base("manual", "a hand moves the floating arm, minimum jerk (Fig. 11)");
  s.floats = true;
  s.response = Response::kLag;
  s.force = random_hand(seed, s.duration);
  return s;
}

Scenario blow_on_testbed1(std::uint64_t seed) {
  Random random(seed);
  Scenario s = base("blow", "a half sine of 100 to 300 N, 10 to 50 ms, on the tip");
  s.duration = 2;
  s.response = Response::kDetection;
  const double way = random.uniform() < 1. / 3 ? 0 : random.uniform() < 0.5 ? -0.6 : 0.6;  // [rad]
  const Moves<Trapezium> move({{.begin = 0.2,
                                .from = 0.1 - way / 2,
                                .to = 0.1 + way / 2,
                                .speed = 0.4,
                                .acceleration = 2}});
  s.reference = move;
  const double sense = random.uniform() < 0.5 ? -1 : 1;
  const double height = sense * random.uniform(100, 300), width = random.uniform(0.01, 0.05);
  const double begin = random.uniform(0.6, 1.5);
  s.contact = [=](double t, const Point&) { return t >= begin && t < begin + width; };
  s.force = [=, on = s.contact](double t, const Point& tip) -> Vector3d {
    return {0, 0, on(t, tip) ? height * std::sin(std::numbers::pi * (t - begin) / width) : 0};
  };
  return s;
}

std::vector<Scenario> scenarios_of_testbed1() {
  std::vector<Scenario> all;

  Scenario model_check =
      base("model_check", "no load; down and up between the limits, 0.2 rad/s (Fig. 10)");
  model_check.reference = buttons(
      kUpper, {{1, Button::kDown}, {8, Button::kUp}, {15, Button::kDown}, {22, Button::kUp}}, 0.2);
  all.push_back(model_check);

  all.push_back(manual_of_testbed1(1));

  Scenario held = hold("hold", "q = 0.5 rad; 3.3 kg hung on at 25 s: 19.9 N m (Fig. 12)");
  held.load = Load{.mass = 3.3, .hang_at = 25};
  all.push_back(held);

  Scenario swing =
      hold("swing", "q = 0.5 rad; 3.3 kg, swung at random from 13 s, dropped at 32 s (Fig. 13)");
  swing.load = Load{.mass = 3.3, .hang_at = 0, .drop_at = 32, .push = random_swing(13, 32)};
  all.push_back(swing);

  Scenario button =
      base("button", "up and down by buttons, 0.25 rad/s; 1.2 kg hung on at 8 s, moving (Fig. 14)");
  button.reference = buttons(kLower,
                             {{1, Button::kUp},
                              {6, Button::kDown},
                              {11, Button::kUp},
                              {16, Button::kDown},
                              {21, Button::kUp}},
                             0.25);
  button.scene = "load";
  button.load = Load{.mass = 1.2, .hang_at = 8};
  all.push_back(button);

  Scenario collision =
      base("collision", "upwards at 0.3 rad/s into an obstacle; a mark stops the motor (Fig. 15)");
  collision.duration = 8;
  collision.response = Response::kDetection;
  collision.reference = buttons(kLower, {{2, Button::kUp}}, 0.3);
  collision.scene = "obstacle";
  collision.reacts = true;
  all.push_back(collision);

  Scenario identify = base("identify", "no load; three sines that excite every term of (36)");
  identify.reference = [](double t, int) {
    Reference sum{0.1, 0, 0};
    for (const auto& [amplitude, w] : {std::pair{0.3, 0.9}, {0.12, 2.9}, {0.04, 7.1}}) {
      const Reference r = sine_motion(amplitude, w, t);
      sum = {sum.q + r.q, sum.qd + r.qd, sum.qdd + r.qdd};
    }
    return sum;
  };
  all.push_back(identify);
  return all;
}

}  // namespace tauext
