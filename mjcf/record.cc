// SPDX-License-Identifier: Apache-2.0
#include "mjcf/record.h"

#include <fmt/format.h>

#include <cmath>
#include <stdexcept>
#include <utility>

#include "mjcf/plant/plant.h"
#include "mjcf/scenarios/motion.h"

namespace tauext {
namespace {

using Eigen::Vector3d;
using Eigen::VectorXd;

Tracking tracking(const Scenario& s, const Recording& r) {
  return {r.Kp.value_or(s.tracking.Kp), r.Kd.value_or(s.tracking.Kd)};
}

// where every joint should be
struct Motion {
  VectorXd q, qd, qdd;
};

VectorXd computed_torque(const Plant& plant, const Motion& ref, const Tracking& c) {
  const VectorXd a = ref.qdd + c.Kp * (ref.q - plant.q()) + c.Kd * (ref.qd - plant.qd());
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
  trace.force.resize(3, samples);
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

// one run of a scenario, sample by sample
class Run {
 public:
  Run(const Model& model, const Scenario& s, const Recording& r, const Sensors& sensors)
      : plant_(model),
        s_(s),
        r_(r),
        control_(tracking(s, r)),
        stream_(sensors, plant_.dof(), plant_.screws()),
        load_(s.load),
        trace_(empty_trace(plant_.dof(), static_cast<int>(std::lround(s.duration / r.Ts)))) {
    trace_.screws = plant_.screws();
    const Motion start = s.start_on_reference ? reference(0) : at_rest(VectorXd::Zero(dof()));
    plant_.set_state(start.q, start.qd);
  }

  Trace operator()(const Supervisor& supervisor) {
    for (int k = 0; k < trace_.size(); ++k) {
      trace_.t[k] = k * r_.Ts;
      apply_input(trace_.t[k]);
      take_sample(k);
      if (supervisor && !stopped_) ask(supervisor, k);
      step();
    }
    if (!only_force_ || trace_.force.isZero(0)) trace_.force.resize(3, 0);
    return std::move(trace_);
  }

 private:
  int dof() const { return plant_.dof(); }

  Motion at_rest(const VectorXd& q) const {
    return {q, VectorXd::Zero(dof()), VectorXd::Zero(dof())};
  }
  Motion reference(double t) const {
    Motion m = at_rest(VectorXd::Zero(dof()));
    for (int i = 0; i < dof(); ++i) {
      const Reference r = s_.reference(t, i);
      m.q[i] = r.q;
      m.qd[i] = r.qd;
      m.qdd[i] = r.qdd;
    }
    return m;
  }

  void apply_input(double t) {
    load_.apply(plant_, t);
    VectorXd tau_ext(dof());
    for (int i = 0; i < dof(); ++i) tau_ext[i] = s_.tau_ext(t, i);
    tip_ = plant_.end_effector();
    force_ = s_.force(t, tip_);
    only_force_ = only_force_ && tau_ext.isZero(0) && !s_.load;
    if (!force_.isZero(0)) tau_ext += plant_.tau_ext_of(force_);
    if (s_.floats && !stopped_) {
      plant_.set_input(plant_.bias(), tau_ext);
    } else {
      const Motion ref = stopped_ ? at_rest(*stopped_) : reference(t);
      plant_.set_input(computed_torque(plant_, ref, control_), tau_ext);
    }
  }

  void take_sample(int k) {
    trace_.q.col(k) = plant_.q();
    trace_.qd.col(k) = plant_.qd();
    trace_.tau.col(k) = plant_.tau();
    const VectorXd stops = limits(k);
    trace_.tau_ext.col(k) = plant_.tau_ext() + stops;
    trace_.force.col(k) = force_;
    trace_.qdd.col(k) = plant_.qdd();
    trace_.friction.col(k) = plant_.friction();
    const bool touched = s_.contact(trace_.t[k], tip_);
    const double by_contacts = plant_.contact_force();
    only_force_ = only_force_ && stops.isZero(0) && by_contacts == 0;
    trace_.contact_force[k] = by_contacts + (touched ? force_.norm() : 0);
    trace_.contact[k] = touched || trace_.contact_force[k] > 0;
  }

  // [N m] what the limits of joints do, where the scenario means to reach them
  VectorXd limits(int k) const {
    const std::vector<int> joints = plant_.joints_at_limits();
    if (joints.empty()) return VectorXd::Zero(dof());
    if (s_.reaches_limits && !plant_.is_tied()) return plant_.limit_torque();
    throw std::runtime_error(fmt::format(
        "scenario {}: joint {} reaches its limit at t = {:g} s, at {:.4g} rad (or m); {}", s_.name,
        joints.front() + 1, trace_.t[k], trace_.q(joints.front(), k),
        plant_.is_tied() ? "an arm whose joints follow others must not; --lock REGEX fixes these"
                         : "a scenario that means to sets reaches_limits"));
  }

  void ask(const Supervisor& supervisor, int k) {
    const auto y = stream_.read({trace_.t[k], plant_.q(), plant_.qd(), plant_.tau()});
    if (!y || !supervisor(*y)) return;
    stopped_ = plant_.q();
    trace_.stopped_at = k;
  }

  void step() {
    try {
      for (int i = 0; i < r_.substeps; ++i) plant_.step(r_.Ts / r_.substeps);
    } catch (const std::runtime_error& e) {
      throw std::runtime_error(fmt::format(
          "scenario {}: {} Tracking may be too stiff for Ts = {} s: Kp = {} 1/s^2, Kd = {} 1/s",
          s_.name, e.what(), r_.Ts, control_.Kp, control_.Kd));
    }
  }

  Plant plant_;
  const Scenario& s_;
  const Recording& r_;
  Tracking control_;
  SensorStream stream_;
  LoadHandler load_;
  Trace trace_;
  Point tip_{};                      // the end effector
  Vector3d force_;                   // [N] of the scenario, there
  bool only_force_ = true;           // makes tau_ext
  std::optional<VectorXd> stopped_;  // where a mark stopped the arm
};

}  // namespace

Trace simulate(const Model& model, const Scenario& scenario, const Recording& recording,
               const Sensors& sensors, const Supervisor& supervisor) {
  check(scenario, recording);
  return Run(model, scenario, recording, sensors)(supervisor);
}

Trace record(const Model& model, const Scenario& scenario, const Sensors& sensors,
             const Recording& recording) {
  return measure(simulate(model, scenario, recording, sensors), sensors);
}

}  // namespace tauext
