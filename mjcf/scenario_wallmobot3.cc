// SPDX-License-Identifier: Apache-2.0
// Section 5.2 of the paper, and a start in motion.
#include <cmath>
#include <numbers>

#include "mjcf/scenario_lists.h"

namespace tauext {
namespace {

double paper_sine(double t) {
  return 10 * std::sin(t) + 5 * std::cos(2 * t + std::numbers::pi / 2) - 5;
}

// the collision of Fig. 7 (b): when, how long, how hard is ours
constexpr double kHitAt = 5, kHitFor = 0.02, kHitForce = 200;  // [s], [s], [N]
bool hit(double t) {
  return t >= kHitAt && t < kHitAt + kHitFor;
}

}  // namespace

std::vector<Scenario> scenarios_of_wallmobot3() {
  Scenario base = quiet();
  base.reference = [](double t) { return sine_motion(0.1, 1, t); };

  std::vector<Scenario> all;
  const auto add = [&](const char* name, const char* description) -> Scenario& {
    all.push_back(base);
    all.back().name = name;
    all.back().description = description;
    return all.back();
  };

  add("free", "no contact; q_ref = 0.1 sin t rad, from rest");

  Scenario& step = add("step", "98.2 N m on every joint from t = 1 s (Fig. 4)");
  step.response = Response::kStep;
  step.tau_ext = [](double t) { return t < 1 ? 0 : 98.2; };

  Scenario& ramp = add("ramp", "from t = 1 s, 5 N m/s on every joint (Fig. 5)");
  ramp.response = Response::kLag;
  ramp.tau_ext = [](double t) { return t < 1 ? 0 : 5 * (t - 1); };

  Scenario& sine =
      add("sine", "10 sin t + 5 cos(2t + pi/2) - 5 N m on every joint (Fig. 6); scored from 3 s");
  sine.response = Response::kLag;
  sine.score_from = 3;
  sine.tau_ext = paper_sine;

  Scenario& collision =
      add("collision",
          "5 sin(t/2) N m, and at t = 5 s a half sine of 200 N, 20 ms on the panel (Fig. 7)");
  collision.response = Response::kDetection;
  collision.tau_ext = [](double t) { return 5 * std::sin(t / 2); };
  collision.contact = hit;
  collision.force = [](double t, const Point&) -> Eigen::Vector3d {
    const double f = hit(t) ? -kHitForce * std::sin(std::numbers::pi * (t - kHitAt) / kHitFor) : 0;
    return {f, 0, 0};
  };

  Scenario& in_motion =
      add("in_motion", "no contact; starts at 0.6 rad/s on q_ref = 0.3 sin 2t rad");
  in_motion.start_on_reference = true;
  in_motion.reference = [](double t) { return sine_motion(0.3, 2, t); };
  return all;
}

}  // namespace tauext
