// SPDX-License-Identifier: Apache-2.0
#include "mjcf/scenarios/wallmobot3.h"

#include <cmath>
#include <numbers>

#include "mjcf/plant/plant.h"
#include "mjcf/scenarios/motion.h"
#include "mjcf/scenarios/touch.h"

namespace tauext {
namespace {

// the collision of Fig. 7 (b): when, how long, how hard is ours
constexpr double kHitAt = 5, kHitFor = 0.02, kHitForce = 200;  // [s], [s], [N]
bool hit(double t) {
  return t >= kHitAt && t < kHitAt + kHitFor;
}

// scenarios on the motion that the paper's have
class List {
 public:
  List() {
    base_ = quiet();
    base_.reference = [](double t, int) { return sine_motion(0.1, 1, t); };
  }
  /// Good until the next one is added.
  Scenario& add(const char* name, const char* description) {
    all.push_back(base_);
    all.back().name = name;
    all.back().description = description;
    return all.back();
  }

  std::vector<Scenario> all;

 private:
  Scenario base_;
};

// section 5.2
void add_those_of_the_paper(List& list) {
  list.add("free", "no contact; q_ref = 0.1 sin t rad, from rest");

  Scenario& step = list.add("step", "98.2 N m on every joint from t = 1 s (Fig. 4)");
  step.response = Response::kStep;
  step.tau_ext = [](double t, int) { return t < 1 ? 0 : 98.2; };

  Scenario& ramp = list.add("ramp", "from t = 1 s, 5 N m/s on every joint (Fig. 5)");
  ramp.response = Response::kLag;
  ramp.tau_ext = [](double t, int) { return t < 1 ? 0 : 5 * (t - 1); };

  Scenario& sine = list.add(
      "sine", "10 sin t + 5 cos(2t + pi/2) - 5 N m on every joint (Fig. 6); scored from 3 s");
  sine.response = Response::kLag;
  sine.score_from = 3;
  sine.tau_ext = [](double t, int) { return paper_sine(t); };

  Scenario& collision =
      list.add("collision",
               "5 sin(t/2) N m, and at t = 5 s a half sine of 200 N, 20 ms on the panel (Fig. 7)");
  collision.response = Response::kDetection;
  collision.tau_ext = [](double t, int) { return 5 * std::sin(t / 2); };
  collision.contact = [](double t, const Point&) { return hit(t); };
  collision.force = [](double t, const Point&) -> Eigen::Vector3d {
    const double f = hit(t) ? -kHitForce * std::sin(std::numbers::pi * (t - kHitAt) / kHitFor) : 0;
    return {f, 0, 0};
  };
}

void add_touches(List& list) {
  // slanted, so that every joint feels them
  const Eigen::Vector3d slanted = Eigen::Vector3d(-0.8, 0, 0.6);

  Scenario& push =
      list.add("push", "slow pushes of 80 N at 5, 12 and 20 s, up in 1 s, held 1 s, and back");
  push.response = Response::kDetection;
  std::vector<Touch> pushes;
  for (const double begin : {5., 12., 20.}) {
    pushes.push_back({TouchKind::kSlowPush, begin, 1, 1, 1, 80 * slanted});
  }
  push = with_touches(push, pushes);

  Scenario& brisk = list.add(
      "brisk_push", "pushes of 100 N at 5, 12 and 20 s, up in 0.1 s, held 0.3 s, back in 0.3 s");
  brisk.response = Response::kDetection;
  for (Touch& p : pushes) {
    p = {TouchKind::kBriskPush, p.begin, 0.1, 0.3, 0.3, 100 * slanted};
  }
  brisk = with_touches(brisk, pushes);

  Scenario& clamp = list.add(
      "clamp",
      "something is caught at 10 s: 200 N, straight up in 0.75 s, held 3 s, back in 0.5 s");
  clamp.response = Response::kDetection;
  clamp = with_touches(clamp, {{TouchKind::kClamp, 10, 0.75, 3, 0.5, 200 * slanted}});
}

}  // namespace

std::vector<Scenario> scenarios_of_wallmobot3() {
  List list;
  add_those_of_the_paper(list);

  Scenario& in_motion =
      list.add("in_motion", "no contact; starts at 0.6 rad/s on q_ref = 0.3 sin 2t rad");
  in_motion.start_on_reference = true;
  in_motion.reference = [](double t, int) { return sine_motion(0.3, 2, t); };

  add_touches(list);

  Scenario& payload =
      list.add("payload", "15 kg hung on the panel by a tether at 8 s, dropped at 20 s");
  payload.scene = "load";
  payload.load = Load{.mass = 15, .hang_at = 8, .drop_at = 20};

  Scenario& contact = list.add(
      "contact", "the panel runs into a ball on a spring near 3.6 s; a mark stops the motors");
  contact.duration = 8;
  contact.response = Response::kDetection;
  contact.scene = "panel_obstacle";
  contact.reacts = true;

  Scenario& chirp =
      list.add("chirp", "10 N m on every joint, swept from 0.5 to 300 rad/s between 2 and 38 s");
  chirp.duration = 40;
  chirp.response = Response::kBandwidth;
  chirp.tau_ext = [](double t, int) { return 10 * swept_sine(t); };
  return list.all;
}

}  // namespace tauext
