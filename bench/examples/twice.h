// SPDX-License-Identifier: Apache-2.0
/// @file
/// An estimator of your own: computed torque (4), smoothed twice. It needs Eigen alone, and by the
/// rules of estimators/runs/runs.h does several runs at once.
#pragma once

#include <cmath>
#include <tuple>

#include "estimators/concepts.h"
#include "estimators/parameters.h"
#include "estimators/sampling.h"

namespace own {
using tauext::Vec;

template <tauext::RobotModel M>
struct Twice {
  static constexpr const char* kName = "twice";
  static constexpr int kDof = M::kDof;
  using Scalar = tauext::ScalarOf<M>;  // double, or a number of each of several runs
  using Model = M;
  template <class Other>
  using For = Twice<Other>;

  struct Parameters {
    Scalar pole = 47;
    static constexpr auto fields() {
      return std::tuple(
          tauext::Field{"pole", &Parameters::pole, "rad/s", 1e-3, 1e6, "larger is faster"});
    }
    static Parameters for_bandwidth(const M&, double w) { return {.pole = w / 0.6436}; }
  };

  explicit Twice(const M& m, const Parameters& parameters = {})
      : model(m), p(tauext::check_parameters(parameters, kName)) {}
  void reset() noexcept { *this = Twice(model, p); }

  tauext::Estimate<kDof, Scalar> update(const tauext::Measurement<kDof, Scalar>& y) noexcept {
    const tauext::Status status = sampling.accept(y);
    if (status == tauext::Status::kOk) {
      const Scalar h = sampling.h();
      const Vec<kDof, Scalar> qdd = (y.qd - qd) / h;
      const Vec<kDof, Scalar> v = 0.5 * (y.qd + qd), x = y.q - 0.5 * h * v;  // half a step ago
      const Vec<kDof, Scalar> rest = model.bias(x, v) + model.friction(v);
      const Vec<kDof, Scalar> raw = sampling.torque(y) - model.inertia(x) * qdd - rest;  // (4)
      using std::exp;
      const Scalar a = exp(-p.pole * h);
      once = raw + a * (once - raw);
      d = once + a * (d - once);
    }
    if (used(status)) qd = y.qd;
    return {d, status, sampling.joints()};
  }

  const Parameters& parameters() const noexcept { return p; }
  auto memory() noexcept { return std::tie(sampling, once, d, qd); }  // all that update() remembers

  M model;
  Parameters p;
  tauext::Sampling<kDof, Scalar> sampling{0.05, limits_of(model)};
  Vec<kDof, Scalar> once = Vec<kDof, Scalar>::Zero(), d = once, qd = once;
};

}  // namespace own
