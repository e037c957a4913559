// SPDX-License-Identifier: Apache-2.0
// An estimator of your own: computed torque (4), smoothed twice. Run
//   own_estimator --benchmark_filter=wallmobot3/step/ --estimator twice,twice:pole=30,twice:pole=90
//   own_estimator --equal-bandwidth 30     it stands beside the others at one bandwidth
#include "bench/bench_main.h"
#include "bench/registry.h"
using namespace tauext;

template <RobotModel M>
struct Twice {
  static constexpr const char* kName = "twice";
  static constexpr int kDof = M::kDof;
  struct Parameters {
    double pole = 47;
    static constexpr auto fields() {
      return std::tuple(Field{"pole", &Parameters::pole, "rad/s", 1e-3, 1e6, "larger is faster"});
    }
    static Parameters for_bandwidth(const M&, double w) { return {.pole = w / 0.6436}; }
  };
  explicit Twice(const M& m, const Parameters& p = {}) : model(m), pole(p.pole) {}
  void reset() noexcept { *this = Twice(model, {pole}); }
  Estimate<kDof> update(const Measurement<kDof>& y) noexcept {
    const Status status = sampling.accept(y);
    if (status == Status::kOk) {
      const double a = std::exp(-pole * sampling.h());
      const Vec<kDof> qdd = (y.qd - qd) / sampling.h();
      const Vec<kDof> rest = model.bias(y.q, y.qd) + model.friction(y.qd);
      const Vec<kDof> raw = sampling.torque(y) - model.inertia(y.q) * qdd - rest;  // (4)
      once = raw + a * (once - raw);
      d = once + a * (d - once);
    }
    if (used(status)) qd = y.qd;
    return {d, status, sampling.joints()};
  }
  M model;
  double pole;  // [rad/s] of both filters
  Sampling<kDof> sampling{0.05, limits_of(model)};
  Vec<kDof> once = Vec<kDof>::Zero(), d = once, qd = once;
};

int main(int argc, char** argv) {
  const auto twice = [](const auto& arm) { return Twice(arm); };
  register_estimator<WallMoBot3>(twice);
  register_file_estimator(twice);
  return bench_main(argc, argv);
}
