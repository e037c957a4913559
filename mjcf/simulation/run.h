// SPDX-License-Identifier: Apache-2.0
/// @file
/// One run of a scenario, whatever simulates the arm.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "mjcf/scenarios/motion.h"
#include "mjcf/scenarios/scenario_type.h"
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
  Run(P plant, const Scenario& s, const Recording& r, const Sensors& sensors)
      : plant_(std::move(plant)),
        s_(s),
        r_(r),
        control_(tracking(s, r)),
        stream_(sensors, plant_.dof(), plant_.screws()),
        load_(s.load),
        regions_(s.regions, plant_),
        trace_(empty_trace(plant_.dof(), static_cast<int>(std::lround(s.duration / r.Ts)))) {
    trace_.screws = plant_.screws();
    const Motion<Vector> start = s.start_on_reference ? reference(0) : at_rest(Vector::Zero(dof()));
    plant_.set_state(start.q, start.qd);
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
  // whether this step is its own, not one beside others
  bool steps_alone() const { return regions_.is_coupled(); }
  void step() {
    try {
      if (regions_.is_coupled())
        return regions_.step(plant_, plant_.tau(), rest_, t_, r_.Ts, r_.substeps);
      for (int i = 0; i < r_.substeps; ++i) plant_.step(r_.Ts / r_.substeps);
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
    if (pressed_with_ > 0) tau_ext += regions_.tau_ext_of(plant_, pressed_with_);
    if (s_.floats && !stopped_) {
      plant_.set_input(plant_.bias(), tau_ext);
    } else {
      const Motion<Vector> ref = stopped_ ? at_rest(*stopped_) : reference(t);
      plant_.set_input(computed_torque(plant_, ref, control_), tau_ext);
    }
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
    const bool touched = s_.contact(trace_.t[k], tip_);
    const double by_contacts = plant_.contact_force();
    only_force_ = only_force_ && stops.isZero(0) && by_contacts == 0 && pressed_with_ == 0;
    trace_.contact_force[k] = by_contacts + pressed_with_ + (touched ? force_.norm() : 0);
    trace_.contact[k] = touched || trace_.contact_force[k] > 0;
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
    const Sample* const y = stream_.read({trace_.t[k], plant_.q(), plant_.qd(), plant_.tau()});
    if (y == nullptr || !supervisor(*y)) return;
    stopped_ = plant_.q();
    trace_.stopped_at = k;
  }

  P plant_;
  const Scenario& s_;
  const Recording& r_;
  Tracking control_;
  SensorStream stream_;
  LoadHandler load_;
  RegionContact<P> regions_;
  Trace trace_;
  Point tip_{};                    // the end effector
  Eigen::Vector3d force_;          // [N] of the scenario, there
  double pressed_with_ = 0;        // [N] of a region, somewhere
  Vector rest_;                    // [N m] tau_ext without it
  double t_ = 0;                   // [s] of the last sample
  bool only_force_ = true;         // makes tau_ext
  std::optional<Vector> stopped_;  // where a mark stopped the arm
};

}  // namespace tauext::detail
