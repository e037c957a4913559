// SPDX-License-Identifier: Apache-2.0
// An estimator of your own: computed torque (4), smoothed twice. Run
//   own_estimator --benchmark_filter=wallmobot3/step/     it is the row "twice"
//   own_estimator --equal-bandwidth 30                    and stands beside the others at one bandwidth
#include "bench/bench_main.h"
#include "bench/registry.h"

template <tauext::RobotModel M>
struct Twice {
  static constexpr const char* kName = "twice";
  static constexpr int kDof = M::kDof;
  struct Parameters {
    double pole = 47;  ///< [rad/s] of both filters: larger is faster and noisier
    static Parameters for_bandwidth(const M&, double w) { return {.pole = w / 0.6436}; }
  };

  explicit Twice(const M& m, const Parameters& p = {}) : model(m), pole(p.pole) {}
  void reset() noexcept { *this = Twice(model, {pole}); }

  tauext::Estimate<kDof> update(const tauext::Measurement<kDof>& y) noexcept {
    const tauext::Status status = sampling.accept(y);
    if (status == tauext::Status::kBadMeasurement) return {d, status};
    if (status == tauext::Status::kOk) {
      const double a = std::exp(-pole * sampling.h());
      const tauext::Vec<kDof> qdd = (y.qd - last.qd) / sampling.h();
      const tauext::Vec<kDof> raw = last.tau - model.inertia(y.q) * qdd - model.bias(y.q, y.qd) -
                                    model.friction(y.qd);  // (4)
      once = raw + a * (once - raw);
      d = once + a * (d - once);
    }
    last = y;
    return {d, status};
  }

  M model;
  double pole;
  tauext::Sampling sampling{0.05};
  tauext::Measurement<kDof> last;
  tauext::Vec<kDof> once = tauext::Vec<kDof>::Zero(), d = once;
};

int main(int argc, char** argv) {
  tauext::register_estimator<tauext::WallMoBot3>(
      [](const auto& arm) { return Twice<tauext::WallMoBot3>(arm); });
  return tauext::bench_main(argc, argv);
}
