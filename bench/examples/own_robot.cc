// SPDX-License-Identifier: Apache-2.0
// A robot of your own: MJCF and closed form of a pendulum, and a scenario for it. Run
//   own_robot --benchmark_filter=pendulum/
#include "bench/bench_main.h"
#include "bench/registry.h"

struct Pendulum {
  static constexpr int kDof = 1;
  using V = tauext::Vec<1>;
  static constexpr double kMass = 2, kLength = 0.5, kInertia = 0.01,
                          kDamping = 0.1;  // own_robot.xml

  tauext::Mat<1> inertia(const V&) const noexcept {
    return tauext::Mat<1>(kInertia + kMass * kLength * kLength);
  }
  V gravity(const V& q) const noexcept {
    return V(kMass * tauext::kGravity * kLength * std::sin(q[0]));
  }
  V bias(const V& q, const V&) const noexcept { return gravity(q); }
  V momentum_bias(const V& q, const V&) const noexcept { return -gravity(q); }
  V friction(const V& qd) const noexcept { return kDamping * qd; }
};

int main(int argc, char** argv) {
  using namespace tauext;
  register_robot("pendulum", Pendulum(), TAUEXT_EXAMPLES "/own_robot.xml");
  Scenario s = quiet();
  s.name = "step";
  s.description = "3 N m from t = 1 s, while it swings by 0.5 sin 2t rad";
  s.response = Response::kStep;
  s.reference = [](double t, int) { return sine_motion(0.5, 2, t); };
  s.tau_ext = [](double t, int) { return t < 1 ? 0 : 3; };
  register_scenario("pendulum", s);
  return bench_main(argc, argv);
}
