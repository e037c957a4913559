// SPDX-License-Identifier: Apache-2.0
/// @file
/// One run of a scenario, whatever simulates the arm.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "mjcf/scenarios/motion.h"
#include "mjcf/scenarios/scenario_type.h"
#include "mjcf/simulation/drivetrain.h"
#include "mjcf/simulation/recording.h"
#include "mjcf/simulation/region_contact.h"
#include "mjcf/trace/sensors.h"
#include "mjcf/trace/trace.h"

namespace tauext::detail {

// the controller's gains
// @throws std::invalid_argument for a recording or gains out of range
Tracking tracking(const Scenario& s, const Recording& r);

// @throws std::runtime_error that names the joint, from 0, at q [rad] or [m]
[[noreturn]] void fail_limit(const Scenario& s, int joint, double t, double q, bool is_tied);
// @throws std::runtime_error for a step that could not be, with its cause
[[noreturn]] void fail_step(const Scenario& s, const Recording& r, const std::string& why);

// where every joint should be
template <class Vector>
struct Motion {
  Vector q, qd, qdd;
};

template <class P>
typename P::Vector computed_torque(const P& plant, const Motion<typename P::Vector>& ref,
                                   const Tracking& c) {
  const typename P::Vector a = ref.qdd + c.Kp * (ref.q - plant.q()) + c.Kd * (ref.qd - plant.qd());
  return plant.inertia().lazyProduct(a) + plant.bias() + plant.damping();
}

// room for `samples` samples of n joints
inline Trace empty_trace(int n, int samples) {
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

  template <class P>
  void apply(P& plant, double t) {
    if constexpr (requires { plant.hang_load(); }) {
      if (load_) handle(plant, t);
    }
  }

 private:
  template <class P>
  void handle(P& plant, double t) {
    const bool hang = t >= load_->hang_at && t < load_->drop_at;
    if (hang && !hung_) plant.hang_load();
    if (!hang && hung_) plant.drop_load();
    hung_ = hang;
    if (hung_ && load_->push) plant.push_load(load_->push(t));
  }

  const std::optional<Load>& load_;
  bool hung_ = false;
};

// one run of a scenario on a Plant or a TreePlant, sample by sample
template <class P>
class Run {
  using Vector = typename P::Vector;

 public:
  // @param usual [N m] ArmTree::usual_torque; may be empty without drives and faults of torque
  Run(P plant, const Scenario& s, const Recording& r, const Sensors& sensors,
      const Eigen::VectorXd& usual)
      : plant_(std::move(plant)),
        s_(s),
        r_(r),
        control_(tracking(s, r)),
        stream_(sensors, plant_.dof(), plant_.screws(), usual),
        load_(s.load),
        regions_(s.regions, plant_),
        drives_(r.drives, plant_, usual, s.duration),
        trace_(empty_trace(plant_.dof(), static_cast<int>(std::lround(s.duration / r.Ts)))) {
    trace_.screws = plant_.screws();
    trace_.usual_torque = usual;
    trace_.torque_at_instants = drives_.elastic();
    for (auto* m : {&trace_.motor_q, &trace_.motor_qd})
      m->resize(dof(), drives_.elastic() ? size() : 0);
    const Motion<Vector> start = s.start_on_reference ? reference(0) : at_rest(Vector::Zero(dof()));
    plant_.set_state(start.q, start.qd);
    parts_ = drives_.any() ? std::max(r.substeps, drives_.parts(plant_, r.Ts)) : r.substeps;
  }

  // nothing if the plant got lost
  std::optional<Trace> operator()(const Supervisor& supervisor) {
    for (int k = 0; k < size(); ++k) {
      if (!sample(k, supervisor)) return std::nullopt;
      step();
    }
    return std::move(*this).trace();
  }

  // the same, sample by sample

  int size() const { return trace_.size(); }
  P& plant() { return plant_; }
  // Steps from sample to sample. In each, what changes within a sample has to be pushed anew.
  int parts() const {
    return regions_.is_coupled() ? std::max(parts_, regions_.parts(r_.Ts) * r_.substeps) : parts_;
  }
  // before such a step, of h [s]
  void push(double h) {
    if (!changes()) return;
    Vector tau_ext = rest_;
    if (regions_.is_coupled()) {
      const double f = regions_.push(plant_, t_, h);
      if (f > 0) tau_ext += regions_.tau_ext_of(plant_, f);
    } else if (pressed_with_ > 0) {
      tau_ext += pressed_by_;
    }
    if (drives_.any()) tau_ext += drives_.push(plant_, t_, h);
    plant_.set_input(drives_.elastic() ? Vector(Vector::Zero(dof())) : motor_, tau_ext);
  }
  // and after it
  void move(double h) {
    if (!changes()) return;
    if (regions_.is_coupled()) regions_.move(h);
    if (drives_.any()) drives_.turn(h);
    t_ += h;
  }
  void step() {
    const int n = parts();
    try {
      for (int i = 0; i < n; ++i) {
        push(r_.Ts / n);
        plant_.step(r_.Ts / n);
        move(r_.Ts / n);
      }
    } catch (const std::runtime_error& e) {
      fail_step(s_, r_, e.what());
    }
  }

  // false if the plant got lost
  bool sample(int k, const Supervisor& supervisor) {
    if constexpr (requires { plant_.is_lost(); }) {
      if (plant_.is_lost()) return false;
    }
    trace_.t[k] = k * r_.Ts;
    apply_input(trace_.t[k]);
    take_sample(k);
    if (supervisor && !stopped_) ask(supervisor, k);
    return true;
  }

  Trace trace() && {
    if (!only_force_ || trace_.force.isZero(0)) trace_.force.resize(3, 0);
    return std::move(trace_);
  }

 private:
  int dof() const { return plant_.dof(); }
  // whether something does within a sample
  bool changes() const { return regions_.is_coupled() || drives_.any(); }

  Motion<Vector> at_rest(const Vector& q) const {
    return {q, Vector::Zero(dof()), Vector::Zero(dof())};
  }
  Motion<Vector> reference(double t) const {
    Motion<Vector> m = at_rest(Vector::Zero(dof()));
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
    Vector tau_ext = Vector::Zero(dof());
    for (int i = 0; i < dof(); ++i) tau_ext[i] = s_.tau_ext(t, i);
    tip_ = plant_.end_effector();
    force_ = s_.force(t, tip_);
    only_force_ = only_force_ && tau_ext.isZero(0) && !s_.load;
    if (!force_.isZero(0)) tau_ext += plant_.tau_ext_of(force_);
    t_ = t, rest_ = tau_ext;
    regions_.look(plant_, t);
    pressed_with_ = regions_.force(plant_, t);
    if (pressed_with_ > 0) {
      pressed_by_ = regions_.tau_ext_of(plant_, pressed_with_);
      tau_ext += pressed_by_;
    }
    const bool floats = s_.floats && !stopped_;
    const Motion<Vector> ref = stopped_ ? at_rest(*stopped_) : reference(t);
    if (drives_.any()) return apply_drives(floats, ref, tau_ext);
    plant_.set_input(floats ? Vector(plant_.bias()) : computed_torque(plant_, ref, control_),
                     tau_ext);
    if (changes()) motor_ = plant_.tau();
  }

  // the controller sees the motors, where springs are, and knows their inertia
  void apply_drives(bool floats, const Motion<Vector>& ref, const Vector& tau_ext) {
    const bool elastic = drives_.elastic();
    Vector tau = plant_.bias();
    if (!floats) {
      const bool started = t_ > 0;
      const Vector q = elastic && started ? drives_.theta() : Vector(plant_.q());
      const Vector qd = elastic && started ? drives_.thetad() : Vector(plant_.qd());
      const Vector a = ref.qdd + control_.Kp * (ref.q - q) + control_.Kd * (ref.qd - qd);
      tau += plant_.inertia().lazyProduct(a) + plant_.damping();
      if (elastic) tau += drives_.rotors().cwiseProduct(a);
      if (elastic && !started) drives_.start(plant_, tau, a);
    } else if (elastic && t_ == 0) {
      drives_.start(plant_, tau, Vector::Zero(dof()));
    }
    plant_.set_input(tau, tau_ext);
    motor_ = plant_.tau();  // as the motors can
    drives_.drive(motor_);
    added_ = drives_.friction(plant_, t_);
    if (elastic) added_ -= drives_.torque(plant_);
    plant_.set_input(elastic ? Vector(Vector::Zero(dof())) : motor_, tau_ext + added_);
  }

  void take_sample(int k) {
    trace_.q.col(k) = plant_.q();
    trace_.qd.col(k) = plant_.qd();
    trace_.tau.col(k) = plant_.tau();
    const Vector stops = limits(k);
    trace_.tau_ext.col(k) = plant_.tau_ext() + stops;
    trace_.force.col(k) = force_;
    trace_.qdd.col(k) = plant_.qdd();
    trace_.friction.col(k) = plant_.friction();
    if (drives_.any()) take_drives(k);
    const bool touched = s_.contact(trace_.t[k], tip_);
    const double by_contacts = plant_.contact_force();
    only_force_ = only_force_ && stops.isZero(0) && by_contacts == 0 && pressed_with_ == 0;
    trace_.contact_force[k] = by_contacts + pressed_with_ + (touched ? force_.norm() : 0);
    trace_.contact[k] = touched || trace_.contact_force[k] > 0;
  }

  // to the plant they are outside; to (3) they are tau and F
  void take_drives(int k) {
    trace_.tau_ext.col(k) -= added_;
    trace_.friction.col(k) += drives_.friction(plant_, trace_.t[k]);
    if (!drives_.elastic()) return;
    trace_.tau.col(k) = drives_.torque(plant_);
    trace_.motor_q.col(k) = drives_.theta();
    trace_.motor_qd.col(k) = drives_.thetad();
  }

  // [N m] what the limits of joints do, where the scenario means to reach them
  Vector limits(int k) const {
    if constexpr (requires { plant_.joints_at_limits(); }) {
      return pressed(k);
    } else {
      return Vector::Zero(dof());
    }
  }
  Vector pressed(int k) const {
    const std::vector<int> joints = plant_.joints_at_limits();
    if (joints.empty()) return Vector::Zero(dof());
    if (s_.reaches_limits && !plant_.is_tied()) return plant_.limit_torque();
    fail_limit(s_, joints.front(), trace_.t[k], trace_.q(joints.front(), k), plant_.is_tied());
  }

  void ask(const Supervisor& supervisor, int k) {
    const Trace& now = trace_;
    const Sample* const y =
        stream_.read({now.t[k], now.encoder_q().col(k), now.encoder_qd().col(k), now.tau.col(k)});
    if (y == nullptr || !supervisor(*y)) return;
    stopped_ = drives_.elastic() ? drives_.theta() : Vector(plant_.q());  // where encoders see it
    trace_.stopped_at = k;
  }

  P plant_;
  const Scenario& s_;
  const Recording& r_;
  Tracking control_;
  SensorStream stream_;
  LoadHandler load_;
  RegionContact<P> regions_;
  Drivetrain<P> drives_;
  int parts_ = 1;  // without regions
  Trace trace_;
  Point tip_{};                    // the end effector
  Eigen::Vector3d force_;          // [N] of the scenario, there
  double pressed_with_ = 0;        // [N] of a region, somewhere
  Vector pressed_by_, rest_;       // [N m] tau_ext of it, and all other
  Vector motor_, added_;           // [N m] of the motors; what drives add to the plant's tau_ext
  double t_ = 0;                   // [s] up to where it is simulated
  bool only_force_ = true;         // makes tau_ext
  std::optional<Vector> stopped_;  // where a mark stopped the arm
};

}  // namespace tauext::detail
