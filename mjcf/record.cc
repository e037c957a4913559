// SPDX-License-Identifier: Apache-2.0
#include "mjcf/record.h"

#include <fmt/format.h>

#include <cmath>
#include <stdexcept>

namespace tauext {
namespace {

using Eigen::VectorXd;

VectorXd computed_torque(const Plant& plant, const Reference& ref, const Tracking& c) {
  const VectorXd q = plant.q(), qd = plant.qd();
  const VectorXd a = (ref.qdd + c.Kp * (ref.q - q.array()) + c.Kd * (ref.qd - qd.array())).matrix();
  return plant.inertia() * a + plant.bias() + plant.friction();
}

void check(const Recording& r) {
  if (!(r.Ts > 0 && r.Ts <= 0.1) || r.substeps < 1 || r.substeps > 1000) {
    throw std::invalid_argument(
        fmt::format("sampling time {} s with {} substeps: 0 < Ts <= 0.1 s and 1 to 1000 substeps",
                    r.Ts, r.substeps));
  }
  if (!(r.tracking.Kp >= 0 && r.tracking.Kp <= 1e6 && r.tracking.Kd >= 0 && r.tracking.Kd <= 1e4)) {
    throw std::invalid_argument(fmt::format("Kp = {} 1/s^2, Kd = {} 1/s: 0 to 1e6 and 0 to 1e4",
                                            r.tracking.Kp, r.tracking.Kd));
  }
}

}  // namespace

Trace record(const Model& model, const Scenario& scenario, const Sensors& sensors,
             const Recording& recording) {
  check(recording);
  Plant plant(model);
  const int n = plant.dof();
  const int samples = static_cast<int>(std::lround(scenario.duration / recording.Ts));
  Trace trace;
  trace.t.resize(samples);
  trace.contact.resize(samples);
  for (auto* m : {&trace.q, &trace.qd, &trace.tau, &trace.tau_ext, &trace.qdd, &trace.friction}) {
    m->resize(n, samples);
  }

  const Reference start = scenario.start_on_reference ? scenario.reference(0) : Reference{};
  plant.set_state(VectorXd::Constant(n, start.q), VectorXd::Constant(n, start.qd));
  for (int k = 0; k < samples; ++k) {
    const double t = k * recording.Ts;
    VectorXd tau_ext = VectorXd::Constant(n, scenario.tau_ext(t));
    if (const double f = scenario.force_x(t); f != 0) {
      tau_ext += plant.tau_ext_of({f, 0, 0}, "end_effector");
    }
    const VectorXd tau = computed_torque(plant, scenario.reference(t), recording.tracking);
    plant.set_input(tau, tau_ext);

    trace.t[k] = t;
    trace.q.col(k) = plant.q();
    trace.qd.col(k) = plant.qd();
    trace.tau.col(k) = tau;
    trace.tau_ext.col(k) = tau_ext;
    trace.qdd.col(k) = plant.qdd();
    trace.friction.col(k) = plant.friction();
    trace.contact[k] = scenario.contact(t);
    try {
      for (int s = 0; s < recording.substeps; ++s) plant.step(recording.Ts / recording.substeps);
    } catch (const std::runtime_error& e) {
      throw std::runtime_error(fmt::format(
          "scenario {}: {} Tracking may be too stiff for Ts = {} s: Kp = {} 1/s^2, Kd = {} 1/s",
          scenario.name, e.what(), recording.Ts, recording.tracking.Kp, recording.tracking.Kd));
    }
  }
  return measure(trace, sensors);
}

}  // namespace tauext
