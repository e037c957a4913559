// SPDX-License-Identifier: Apache-2.0
#include "mjcf/record.h"

#include <fmt/format.h>

#include <cmath>
#include <stdexcept>

namespace tauext {
namespace {

using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr const char* kEndEffector = "end_effector";

Tracking tracking(const Scenario& s, const Recording& r) {
  return {r.Kp.value_or(s.tracking.Kp), r.Kd.value_or(s.tracking.Kd)};
}

VectorXd computed_torque(const Plant& plant, const VectorXd& q_ref, const Reference& ref,
                         const Tracking& c) {
  const VectorXd q = plant.q(), qd = plant.qd();
  const VectorXd a = (ref.qdd + c.Kp * (q_ref - q).array() + c.Kd * (ref.qd - qd.array())).matrix();
  return plant.inertia() * a + plant.bias() + plant.damping();
}

void check(const Scenario& s, const Recording& r) {
  if (!(r.Ts > 0 && r.Ts <= 0.1) || r.substeps < 1 || r.substeps > 1000) {
    throw std::invalid_argument(
        fmt::format("sampling time {} s with {} substeps: 0 < Ts <= 0.1 s and 1 to 1000 substeps",
                    r.Ts, r.substeps));
  }
  const Tracking c = tracking(s, r);
  if (!(c.Kp >= 0 && c.Kp <= 1e6 && c.Kd >= 0 && c.Kd <= 1e4)) {
    throw std::invalid_argument(
        fmt::format("Kp = {} 1/s^2, Kd = {} 1/s: 0 to 1e6 and 0 to 1e4", c.Kp, c.Kd));
  }
}

// room for `samples` samples of n joints
Trace empty_trace(int n, int samples) {
  Trace trace;
  trace.t.resize(samples);
  trace.contact.resize(samples);
  trace.contact_force.resize(samples);
  for (auto* m : {&trace.q, &trace.qd, &trace.tau, &trace.tau_ext, &trace.qdd, &trace.friction}) {
    m->resize(n, samples);
  }
  return trace;
}

// hangs, pushes and drops the load when its time has come
class LoadHandler {
 public:
  explicit LoadHandler(const std::optional<Load>& load) : load_(load) {}

  void apply(Plant& plant, double t) {
    if (!load_) return;
    const bool hang = t >= load_->hang_at && t < load_->drop_at;
    if (hang && !hung_) plant.hang_load();
    if (!hang && hung_) plant.drop_load();
    hung_ = hang;
    if (hung_ && load_->push) plant.push_load(load_->push(t));
  }

 private:
  const std::optional<Load>& load_;
  bool hung_ = false;
};

}  // namespace

Trace simulate(const Model& model, const Scenario& s, const Recording& r, const Sensors& sensors,
               const Supervisor& supervisor) {
  check(s, r);
  Plant plant(model);
  const int n = plant.dof();
  const int samples = static_cast<int>(std::lround(s.duration / r.Ts));
  const Tracking control = tracking(s, r);
  Trace trace = empty_trace(n, samples);
  trace.screws = plant.screws();
  SensorStream stream(sensors, n, plant.screws());
  LoadHandler load(s.load);
  std::optional<VectorXd> stopped;  // where

  const Reference start = s.start_on_reference ? s.reference(0) : Reference{};
  plant.set_state(VectorXd::Constant(n, start.q), VectorXd::Constant(n, start.qd));
  for (int k = 0; k < samples; ++k) {
    const double t = k * r.Ts;
    load.apply(plant, t);
    VectorXd tau_ext = VectorXd::Constant(n, s.tau_ext(t));
    if (const Vector3d f = s.force(t, plant.site(kEndEffector)); !f.isZero(0)) {
      tau_ext += plant.tau_ext_of(f, kEndEffector);
    }
    const Reference ref = stopped ? Reference{} : s.reference(t);
    const VectorXd q_ref = stopped ? *stopped : VectorXd::Constant(n, ref.q);
    plant.set_input(
        s.floats && !stopped ? plant.bias() : computed_torque(plant, q_ref, ref, control), tau_ext);

    trace.t[k] = t;
    trace.q.col(k) = plant.q();
    trace.qd.col(k) = plant.qd();
    trace.tau.col(k) = plant.tau();
    trace.tau_ext.col(k) = plant.tau_ext();
    trace.qdd.col(k) = plant.qdd();
    trace.friction.col(k) = plant.friction();
    trace.contact_force[k] = plant.contact_force();
    trace.contact[k] = s.contact(t) || trace.contact_force[k] > 0;
    if (supervisor && !stopped &&
        supervisor(stream.read({t, trace.q.col(k), trace.qd.col(k), trace.tau.col(k)}))) {
      stopped = plant.q();
      trace.stopped_at = k;
    }
    try {
      for (int i = 0; i < r.substeps; ++i) plant.step(r.Ts / r.substeps);
    } catch (const std::runtime_error& e) {
      throw std::runtime_error(fmt::format(
          "scenario {}: {} Tracking may be too stiff for Ts = {} s: Kp = {} 1/s^2, Kd = {} 1/s",
          s.name, e.what(), r.Ts, control.Kp, control.Kd));
    }
  }
  return trace;
}

Trace record(const Model& model, const Scenario& scenario, const Sensors& sensors,
             const Recording& recording) {
  return measure(simulate(model, scenario, recording, sensors), sensors);
}

}  // namespace tauext
