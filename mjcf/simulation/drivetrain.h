// SPDX-License-Identifier: Apache-2.0
/// @file
/// Motors behind springs, and the friction of links, beside a simulated arm.
#pragma once

#include <Eigen/Core>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "mjcf/simulation/recording.h"

namespace tauext::detail {

// @throws std::invalid_argument for drives out of range, or of joints whose usual torque nobody
// knows
void check(const Drives& drives, int joints, const Eigen::VectorXd& usual_torque);

// Of a Plant or a TreePlant, which gets the springs' torque and the friction as parts of tau_ext:
// both change within a sample. After Spong 1987, where a rotor turns about its joint alone:
//     B(q) qdd + C qd + g + F + tau_ext = tau,  tau = K (theta - q) + D (thetad - qd),
//     R thetadd + tau = tau_motor.
template <class P>
class Drivetrain {
  using Vector = typename P::Vector;

 public:
  Drivetrain(const Drives& d, const P& plant, const Eigen::VectorXd& usual_torque, double duration)
      : d_(d), duration_(duration) {
    if (d == Drives()) return;
    check(d, plant.dof(), usual_torque);
    const Vector u = usual_torque;  // NOLINT(performance-unnecessary-copy-initialization)
    K_ = d.stiffness * u;
    R_ = d.rotor * u;
    D_ = 2 * d.damping * (K_.array() * R_.array()).sqrt();
    coulomb_ = d.coulomb * u;
    viscous_ = d.viscous * u;
    theta_ = thetad_ = motor_ = Vector::Zero(plant.dof());
  }

  bool elastic() const { return d_.elastic(); }
  bool any() const { return d_.any(); }

  // Parts of h [s] in which, where the arm is now, a spring's fastest oscillation turns by 0.2 rad
  // at most, and friction would take a link's speed in one of them at its first rate.
  // @throws std::invalid_argument for more of them than anybody waits for
  int parts(const P& plant, double h) const {
    constexpr double kMost = 1000;
    const Vector mobility = plant.inertia().inverse().diagonal();  // [1/(kg m^2)]
    double rate = 0;
    if (elastic())
      rate = std::sqrt((K_.array() * (R_.array().inverse() + mobility.array())).maxCoeff()) / 0.2;
    const Vector slope = coulomb_ * (1 + d_.stribeck) / kFrictionTurns + viscous_;
    rate = std::max(rate, (1 + d_.drift) * slope.cwiseProduct(mobility).maxCoeff());
    if (h * rate <= kMost) return std::max(1, static_cast<int>(std::ceil(h * rate)));
    throw std::invalid_argument(
        "drives: springs or friction that take more than 1000 steps in a sample; less stiffness or "
        "coulomb, or more rotor, helps");
  }

  // Springs that hold what this torque of the motors moves with these accelerations.
  void start(const P& plant, const Vector& motor, const Vector& qdd) {
    if (!elastic()) return;
    thetad_ = plant.qd();
    theta_ = plant.q() + Vector((motor - R_.cwiseProduct(qdd)).cwiseQuotient(K_));
  }
  // what the motors do from now on
  void drive(const Vector& motor) { motor_ = motor; }

  const Vector& theta() const { return theta_; }
  const Vector& thetad() const { return thetad_; }
  // [N m] what the motors' inertia adds to B
  const Vector& rotors() const { return R_; }

  // [N m] of the springs, so many seconds ahead
  Vector torque(const P& plant, double ahead = 0) const {
    const Vector twist = theta_ - plant.q() + ahead * (thetad_ - plant.qd());
    return K_.cwiseProduct(twist) + D_.cwiseProduct(thetad_ - plant.qd());
  }
  // [N m] of the links, beside the plant's
  Vector friction(const P& plant, double t) const {
    Vector f = Vector::Zero(plant.dof());
    const double now = 1 + d_.drift * (1 - 2 * t / duration_);
    for (Eigen::Index i = 0; i < f.size(); ++i) {
      const double v = plant.qd()[i], slow = v / kStribeckSpeed;
      f[i] = now * (coulomb_[i] * (1 + d_.stribeck * std::exp(-slow * slow)) *
                        std::tanh(v / kFrictionTurns) +
                    viscous_[i] * v);
    }
    return f;
  }
  // what is to be added to the plant's tau_ext from t on, for h [s]: of second order, as leapfrog
  Vector push(const P& plant, double t, double h) {
    Vector f = friction(plant, t);
    if (!elastic()) return f;
    pull_ = torque(plant, h / 2);
    return f - pull_;
  }
  // h [s] on
  void turn(double h) {
    if (!elastic()) return;
    const Vector a = (motor_ - pull_).cwiseQuotient(R_);
    theta_ += h * (thetad_ + h / 2 * a);
    thetad_ += h * a;
  }

 private:
  Drives d_;
  double duration_;
  Vector K_, R_, D_;          // [N m/rad], [kg m^2], [N m s/rad]
  Vector coulomb_, viscous_;  // [N m], [N m s/rad]
  Vector theta_, thetad_;     // [rad], [rad/s] of the motors
  Vector motor_, pull_;       // [N m] of the motors, of the springs
};

}  // namespace tauext::detail
