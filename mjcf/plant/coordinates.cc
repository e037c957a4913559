// SPDX-License-Identifier: Apache-2.0
#include "mjcf/plant/coordinates.h"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "mjcf/mujoco/layout.h"
#include "mjcf/mujoco/measured.h"
#include "mjcf/mujoco/mujoco_functions.h"
#include "mjcf/mujoco/ties.h"

namespace tauext {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

// whether some actuator's coordinate is a fixed tendon: then the actuators say what a joint is
bool has_tendon_coordinates(const mjModel& m) {
  for (int i = 0; i < m.nu; ++i) {
    if (m.actuator_trntype[i] == mjTRN_TENDON &&
        m.wrap_type[m.tendon_adr[m.actuator_trnid[2 * i]]] == mjWRAP_JOINT) {
      return true;
    }
  }
  return false;
}

// the actuators' coordinates, or MuJoCo's
void set_coordinates(const mjModel& m, ArmCoordinates& c) {
  const Ties ties = ties_of(m);
  c.drho = ties.T;
  c.rho0 = ties.rho0;
  c.leaders = ties.free;
  if (!has_tendon_coordinates(m)) return;
  if (has_ties(m))
    throw std::invalid_argument(
        "motors on tendons, and joints that follow others: not supported together");
  const State d = initial_state(m);
  const Layout l = layout_of(m, *d);
  for (int i = 0; i < l.dof; ++i) {
    if (m.actuator_gear[6 * i] == 1) continue;
    throw std::invalid_argument(
        fmt::format("motor {} has a gear of {}: where motors on tendons say what the joint "
                    "coordinates are, their gears must be 1",
                    i, m.actuator_gear[6 * i]));
  }
  if (static_cast<int>(l.arm.size()) != m.nv)
    throw std::invalid_argument("the motors do not move every joint of the model");
  c.drho = l.T;
  c.rho0 = l.rho0;
}

// of joints, and of those that follow them
void set_ranges(const mjModel& m, ArmCoordinates& c) {
  constexpr double kNone = std::numeric_limits<double>::infinity();
  c.lower = VectorXd::Constant(c.dof(), -kNone);
  c.upper = VectorXd::Constant(c.dof(), kNone);
  if (has_tendon_coordinates(m)) return;
  for (int i = 0; i < m.njnt; ++i) {
    if (!m.jnt_limited[i]) continue;
    const auto end = [&](int which) {  // beyond 1e6, none is meant
      const double x = m.jnt_range[2 * i + which];
      return std::abs(x) < 1e6 ? x : std::copysign(kNone, x);
    };
    const double range[] = {end(0), end(1)};
    Eigen::Index k = 0;
    c.drho.row(i).cwiseAbs().maxCoeff(&k);
    const double factor = c.drho(i, k), at = c.rho0[i];
    if (factor == 0) {
      if (at >= range[0] && at <= range[1]) continue;
      throw std::invalid_argument(fmt::format(
          "{} is held at {:.4g}, outside its range; --lock REGEX fixes it", joint_name(m, i), at));
    }
    const double ends[] = {(range[0] - at) / factor, (range[1] - at) / factor};
    c.lower[k] = std::max(c.lower[k], std::min(ends[0], ends[1]));
    c.upper[k] = std::min(c.upper[k], std::max(ends[0], ends[1]));
    if (c.lower[k] < c.upper[k]) continue;
    throw std::invalid_argument(fmt::format(
        "{}: its range and those of the joints that follow it have nothing in common; --lock "
        "REGEX fixes them",
        joint_name(m, c.leaders[static_cast<std::size_t>(k)])));
  }
}

// over poses that fill the range evenly: multiples of square roots of primes, modulo 1; the arm's
// coordinates are the first ones
void set_usual(const mjModel& m, ArmCoordinates& c) {
  constexpr int kPoses = 200;
  constexpr double kAcceleration = 10;  // [rad/s^2] or [m/s^2]
  constexpr double kPrimes[] = {2, 3, 5, 7, 11, 13, 17, 19};
  const State d = initial_state(m);
  const Ties ties = ties_of(m);
  c.usual_torque = VectorXd::Zero(c.dof());
  c.mobility = VectorXd::Zero(m.nv);
  for (int k = 0; k < kPoses; ++k) {
    VectorXd free = VectorXd::Zero(ties.T.cols());
    for (int n = 0; n < c.dof(); ++n) {
      const int i = ties.free[static_cast<std::size_t>(n)];
      double lower = c.lower[n], upper = c.upper[n];
      if (std::isinf(lower) && std::isinf(upper) && m.jnt_limited[i])
        lower = m.jnt_range[2 * i], upper = m.jnt_range[2 * i + 1];
      const auto [from, to] = finite_range(lower, upper, m.jnt_type[i] == mjJNT_SLIDE);
      const double turns = k * std::sqrt(kPrimes[n % 8]);
      free[n] = from + (to - from) * (turns - std::floor(turns));
    }
    VectorXd::Map(d->qpos, m.nv) = ties.T * free + ties.rho0;
    mj_fwdPosition(&m, d.get());
    mj_fwdVelocity(&m, d.get());
    const MatrixXd M = mass_matrix(m, *d);
    const VectorXd gravity = c.drho.transpose() * VectorXd::Map(d->qfrc_bias, m.nv);
    const VectorXd inertia = (c.drho.transpose() * M * c.drho).diagonal();
    c.usual_torque = c.usual_torque.cwiseMax(gravity.cwiseAbs());
    c.usual_torque = c.usual_torque.cwiseMax(kAcceleration * inertia);
    const MatrixXd moved = ties.T * (ties.T.transpose() * M * ties.T).inverse();
    c.mobility = c.mobility.cwiseMax(moved.cwiseProduct(ties.T).rowwise().sum());
  }
}

}  // namespace

std::pair<double, double> finite_range(double lower, double upper, bool slides) {
  const double most = slides ? 0.5 : 3.14159;
  if (std::isinf(lower) && std::isinf(upper)) return {-most, most};
  return {std::isinf(lower) ? upper - 2 * most : lower,
          std::isinf(upper) ? lower + 2 * most : upper};
}

ArmCoordinates coordinates_of(const mjModel& m) {
  ArmCoordinates c;
  set_coordinates(m, c);
  set_ranges(m, c);
  set_usual(m, c);
  return c;
}

VectorXd torque_gains_of(const Model& model) {
  const std::vector<int> leaders = coordinates_of(*model).leaders;
  VectorXd gains = VectorXd::Ones(static_cast<Eigen::Index>(leaders.size()));
  for (std::size_t i = 0; i < leaders.size(); ++i)
    if (const double gain = measured(*model, leaders[i]).torque_gain; gain != 0)
      gains[static_cast<Eigen::Index>(i)] = gain;
  return gains;
}

VectorXd usual_torque_of(const Model& model) {
  constexpr double kNone = std::numeric_limits<double>::infinity();
  const mjModel& m = *model;
  const Layout l = layout_of(m, *initial_state(m));
  if (static_cast<int>(l.arm.size()) == m.nv) return coordinates_of(m).usual_torque;
  ArmCoordinates arm;  // rows of what stands around it are 0
  arm.drho = MatrixXd::Zero(m.nv, l.dof);
  for (std::size_t i = 0; i < l.arm.size(); ++i)
    arm.drho.row(l.arm[i]) = l.T.row(static_cast<Eigen::Index>(i));
  arm.lower = VectorXd::Constant(l.dof, -kNone);
  arm.upper = VectorXd::Constant(l.dof, kNone);
  set_usual(m, arm);
  return arm.usual_torque;
}

}  // namespace tauext
