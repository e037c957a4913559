// SPDX-License-Identifier: Apache-2.0
#include "mjcf/scenarios/generic.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <utility>

#include "mjcf/plant/coordinates.h"
#include "mjcf/plant/plant.h"
#include "mjcf/plant/tree.h"
#include "mjcf/scenarios/motion.h"
#include "mjcf/scenarios/touch.h"
#include "mjcf/trace/random.h"

namespace tauext {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr double kBlow = 0.02;  // [s] how long a blow takes

// half of each joint's range, and the middle of it
struct Ranges {
  VectorXd middle, half;  // [rad] or [m]

  explicit Ranges(const ArmTree& arm) : middle(VectorXd::Zero(arm.dof())), half(arm.dof()) {
    for (int i = 0; i < arm.dof(); ++i) {
      const auto [from, to] = finite_range(arm.lower[i], arm.upper[i], arm.slides(i));
      middle[i] = (from + to) / 2;
      half[i] = std::min(arm.slides(i) ? 0.5 : 3.14159, (to - from) / 2);
    }
  }
};

// how many times `load` [N m] may act at once, beside what acts already: then no joint goes further
// than `way` against the controller
double share_of(const Plant& plant, const VectorXd& load, const VectorXd& way,
                const VectorXd& beside) {
  const VectorXd by_load = plant.inertia().partialPivLu().solve(load),
                 before = plant.inertia().partialPivLu().solve(beside);
  const Eigen::ArrayXd left = Tracking().Kp * way.array() - before.array() * by_load.array().sign();
  return (left / by_load.array().abs().max(1e-300)).minCoeff();
}
double share_of(const Plant& plant, const VectorXd& load, const VectorXd& way) {
  return share_of(plant, load, way, VectorXd::Zero(load.size()));
}

// between both
Vector3d slanted(const ArmScale& scale) {
  return (scale.directions.col(0) + scale.directions.col(1)).normalized();
}

// [N] what the drives hold of a force that gives each joint so many N m a newton; 1e300 if nobody
// knows what they can do. One that could not hold the arm is a placeholder.
double held_force(const ArmTree& arm, const VectorXd& torque) {
  double most = 1e300;
  for (int i = 0; i < arm.dof(); ++i)
    if (arm.rated_torque[i] > 0)
      most = std::min(most, std::max(arm.rated_torque[i], arm.usual_torque[i]) /
                                std::max(std::abs(torque[i]), 1e-9));
  return most;
}

// What the joints are used to where the file states what their drives can do, and no rotors, which
// would show how heavy a load may be. An effort below what a joint is used to is a placeholder, and
// so are all where each is far above that.
VectorXd usual_by_effort(const ArmTree& arm) {
  constexpr double kMost = 10;   // [1] times what the joint is used to
  constexpr double kMuch = 1e5;  // [N m] or [N]
  VectorXd usual = arm.usual_torque;
  double least = kMuch;  // [1]
  for (int i = 0; i < arm.dof(); ++i) {
    const double effort = arm.rated_torque[i];
    const auto leader = static_cast<std::size_t>(arm.leaders[static_cast<std::size_t>(i)]);
    if (arm.joints[leader].armature > 0 || effort < usual[i] || effort >= kMuch) continue;
    least = std::min(least, effort / usual[i]);
    usual[i] = std::min(effort, kMost * usual[i]);
  }
  return least <= kMost ? usual : arm.usual_torque;
}

void set_forces(const Plant& plant, const ArmTree& arm, const VectorXd& way, ArmScale& scale) {
  const MatrixXd J = plant.end_effector_jacobian();
  const MatrixXd mobility = J * plant.inertia().partialPivLu().solve(J.transpose());  // [1/kg]
  const Eigen::SelfAdjointEigenSolver<MatrixXd> by_mobility(mobility);
  const VectorXd& gives = by_mobility.eigenvalues();
  const bool planar = !(gives[1] > 1e-3 * gives[2]);
  for (int i = 0; i < 2; ++i) {
    const Vector3d u = by_mobility.eigenvectors().col(planar ? 2 : 2 - i);
    Eigen::Index largest = 0;
    u.cwiseAbs().maxCoeff(&largest);
    scale.directions.col(i) = u[largest] < 0 ? -u : u;
  }
  if (!(gives[2] > 1e-6)) return;  // it weighs a thousand tons
  const Vector3d u = slanted(scale);
  scale.mass = 1 / u.dot(mobility * u);
  const VectorXd torque = J.transpose() * u;  // [N m/N]
  const double held = std::min(300., held_force(arm, torque));
  const double most = std::min(20 * scale.mass, held);
  const double bearable = share_of(plant, torque, way);
  scale.force = scale.blow = std::min(most, bearable);
  scale.gives_way = bearable < most;
  if (!scale.by_effort) return;
  // after 2 T / pi of its peak, the critically damped controller lets it go on by v / (e w)
  const double in_blow = M_PI * M_E / (2 * kBlow * std::sqrt(Tracking().Kp)) * bearable;
  scale.blow = std::min(held, in_blow);
  scale.gives_way = in_blow < held;
}

// a one-sided spring and damper in the way of the end effector
struct Pad {
  Vector3d place, normal;       // [m], and where the end effector comes to
  double stiffness, viscosity;  // [N/m], [N s/m]

  Vector3d operator()(const Point& tip) const {
    const double depth = (tip.position - place).dot(normal);
    if (depth <= 0) return Vector3d::Zero();
    return -std::max(0., stiffness * depth + viscosity * tip.velocity.dot(normal)) * normal;
  }
};

// from rest at home, and back
Reference to_and_fro(const ArmScale& scale, int joint, double share, double w, double t) {
  const double A = share * scale.amplitude[joint];
  return {scale.home[joint] + A * (1 - std::cos(w * t)), A * w * std::sin(w * t),
          A * w * w * std::cos(w * t)};
}

class Generic {
 public:
  explicit Generic(const Model& model) : plant_(model), scale_(scale_of(model)) {}

  std::vector<Scenario> operator()() && {
    add_loads();
    if (scale_.force > 0) add_touches();
    return std::move(all_);
  }

 private:
  // from rest at home and back, once in 2 pi s
  Scenario& add(const char* name, std::string description, Response response) {
    Scenario s = quiet();
    s.name = name;
    s.description = std::move(description);
    s.duration = 20;
    s.response = response;
    s.start_on_reference = true;
    s.reference = [scale = scale_](double t, int i) { return to_and_fro(scale, i, 1, 1, t); };
    all_.push_back(std::move(s));
    return all_.back();
  }

  // torques of the arm's own size times profile(t)
  template <class Profile>
  void load(Scenario& s, Profile profile) const {
    s.tau_ext = [torque = scale_.torque, profile](double t, int i) {
      return torque[i] * profile(t);
    };
  }

  void add_loads() {
    const std::string of = fmt::format("loads of {:.3g} to {:.3g} N m", scale_.torque.minCoeff(),
                                       scale_.torque.maxCoeff());
    add("free", "no contact; about a bent pose by 0.1 rad and back, from rest", Response::kNone);
    load(add("step", of + " from t = 1 s", Response::kStep),
         [](double t) { return t < 1 ? 0. : 1.; });
    load(add("ramp", of + ", grown in a straight line from 1 to 20 s", Response::kLag),
         [](double t) { return std::max(0., t - 1) / 19; });
    Scenario& sine = add("sine", of + ", by the sines of Fig. 6; scored from 3 s", Response::kLag);
    sine.score_from = 3;
    load(sine, [](double t) { return paper_sine(t) / 20; });
    Scenario& in_motion =
        add("in_motion", "no contact; starts at full speed on a sine of 2 rad/s", Response::kNone);
    in_motion.reference = [scale = scale_](double t, int i) {
      Reference r = sine_motion(3 * scale.amplitude[i], 2, t);
      r.q += scale.home[i];
      return r;
    };
    Scenario& chirp = add("chirp", "half of these loads, swept from 0.5 to 300 rad/s, 2 to 38 s",
                          Response::kBandwidth);
    chirp.duration = 40;
    load(chirp, [](double t) { return swept_sine(t) / 2; });
  }

  void add_touches() {
    const double f = scale_.force;
    const Vector3d push = f * slanted(scale_);
    Scenario& pushed = add("push", fmt::format("slow pushes of {:.3g} N at 4, 9 and 14 s", f / 4),
                           Response::kDetection);
    std::vector<Touch> pushes;
    for (const double t : {4., 9., 14.})
      pushes.push_back({TouchKind::kSlowPush, t, 1, 1, 1, push / 4});
    pushed = with_touches(pushed, pushes);
    const Vector3d hit = scale_.blow * slanted(scale_);
    Scenario& blow =
        add("blow", fmt::format("half sines of {:.3g} N, 20 ms, at 5, 10 and 15 s", scale_.blow),
            Response::kDetection);
    std::vector<Touch> blows;
    for (const double t : {5., 10., 15.})
      blows.push_back({TouchKind::kBlow, t, kBlow, 0, 0, t == 10 ? Vector3d(-hit) : hit});
    blow = with_touches(blow, blows);
    Scenario& clamp =
        add("clamp", fmt::format("something is caught at 8 s: {:.3g} N in 0.75 s, held 3 s", f),
            Response::kDetection);
    clamp = with_touches(clamp, {{TouchKind::kClamp, 8, 0.75, 3, 0.5, push}});
    add_contact();
  }

  // half way between home and a pose beside it stands a pad; two thirds as stiff as the end
  // effector's mass allows at 1 kHz
  void add_contact() {
    const VectorXd to = scale_.home + 2 * scale_.amplitude;
    const Vector3d begin = tip(scale_.home), way = tip(to) - begin;
    if (!(way.norm() > 1e-3)) return;
    const MatrixXd J = plant_.end_effector_jacobian();
    const Vector3d n = way.normalized();
    const double mass = 1 / n.dot(J * plant_.inertia().partialPivLu().solve(J.transpose() * n));
    const double w = 60, damping = 0.3;  // [rad/s], [1]
    const Pad pad{begin + way / 2, n, mass * w * w, 2 * damping * mass * w};
    Scenario& s =
        add("contact",
            fmt::format("runs into a pad of {:.3g} N/mm near 2 s; a mark stops the motors",
                        pad.stiffness / 1000),
            Response::kDetection);
    s.duration = 8;
    s.reacts = true;
    s.reference = [scale = scale_](double t, int i) {
      return reference_at(MinimumJerk{.begin = 1,
                                      .duration = 2,
                                      .from = scale.home[i],
                                      .to = scale.home[i] + 2 * scale.amplitude[i]},
                          t);
    };
    s.force = [pad](double, const Point& at) { return pad(at); };
    s.contact = [pad](double, const Point& at) { return !pad(at).isZero(0); };
  }

  Vector3d tip(const VectorXd& q) {
    plant_.set_state(q, VectorXd::Zero(plant_.dof()));
    return plant_.end_effector().position;
  }

  Plant plant_;
  ArmScale scale_;
  std::vector<Scenario> all_;
};

}  // namespace

ArmScale scale_of(const Model& model) {
  Plant plant(model);
  const ArmTree arm = tree_of(model);
  const Ranges r(arm);
  ArmScale scale;
  scale.home = r.middle + (r.half / 4).cwiseMin(0.4);
  scale.amplitude = (r.half / 16).cwiseMin(0.1);
  scale.reach = (0.75 * (r.half + r.middle - scale.home)).cwiseMin(0.8);
  plant.set_state(scale.home, VectorXd::Zero(plant.dof()));
  const VectorXd way = (r.half / 8).cwiseMin(0.05);
  const VectorXd usual = usual_by_effort(arm);
  scale.by_effort = usual != arm.usual_torque;
  set_forces(plant, arm, way, scale);
  const VectorXd hand = scale.force * plant.end_effector_jacobian().colwise().norm().transpose();
  scale.usual_torque = usual.cwiseMax(3 * hand);
  const auto loads = [&](const VectorXd& used_to) -> VectorXd {
    return used_to / 5 * std::min(1., share_of(plant, used_to / 5, way));
  };
  const VectorXd least = loads(arm.usual_torque.cwiseMax(3 * hand));
  scale.torque = loads(scale.usual_torque);
  if ((scale.torque - least).minCoeff() >= 0) return scale;
  // no joint has less for its effort
  const VectorXd more = scale.usual_torque / 5 - least;
  scale.torque = least + std::min(1., share_of(plant, more, way, least)) * more;
  return scale;
}

std::vector<Scenario> generic_scenarios(const Model& model) {
  return Generic(model)();
}

std::vector<Touch> touches_of(const ArmScale& scale, TouchKind kind, std::uint64_t seed) {
  std::vector<Touch> all = draw_touches(kind, seed, kFirstTouch, quiet().duration);
  for (Touch& t : all) {  // drawn in the plane of x and z, 300 N at most
    const Eigen::Vector2d f = t.force(std::vector{0, 2}) / 300;
    t.force = (kind == TouchKind::kBlow ? scale.blow : scale.force) * scale.directions * f;
  }
  return all;
}

Scenario touched_arm(const ArmScale& scale, TouchKind kind, std::uint64_t seed) {
  Random random(seed, 999);
  const double share = random.uniform(0.5, 1), w = random.uniform(0.5, 1);
  Scenario s = quiet();
  s.name = "touched";
  s.description = "drawn touches of one kind";
  s.response = Response::kDetection;
  s.start_on_reference = true;
  s.reference = [scale, share, w](double t, int i) { return to_and_fro(scale, i, share, w, t); };
  return with_touches(s, touches_of(scale, kind, seed));
}

}  // namespace tauext
