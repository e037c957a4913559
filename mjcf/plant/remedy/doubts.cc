// SPDX-License-Identifier: Apache-2.0
#include "mjcf/plant/remedy/doubts.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "mjcf/mujoco/mujoco_functions.h"
#include "mjcf/trace/printable.h"

namespace tauext {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// what moves as one
struct Moving {
  double mass = 0;                      // [kg]
  Vector3d first = Vector3d::Zero();    // [kg m] moment about the world's origin
  Matrix3d inertia = Matrix3d::Zero();  // [kg m^2] about that
  Vector3d anchor = Vector3d::Zero();   // [m] of its first joint
  double way = 0;                       // [m] to there from the first joint of all, by the others

  Vector3d center() const { return mass > 0 ? Vector3d(first / mass) : anchor; }
};

// of a unit mass at r
Matrix3d point_inertia(const Vector3d& r) {
  return r.squaredNorm() * Matrix3d::Identity() - r * r.transpose();
}

// by the number of the body that carries the others; where the arm is at its initial state
std::vector<Moving> moving_parts(const mjModel& m) {
  const State d = initial_state(m);
  std::vector<Moving> all(static_cast<std::size_t>(m.nbody));
  for (int b = 1; b < m.nbody; ++b) {
    const int carrier = m.body_weldid[b];
    if (carrier == 0) continue;  // it never moves
    Moving& own = all[static_cast<std::size_t>(carrier)];
    if (carrier == b) {
      own.anchor = Vector3d::Map(d->xanchor + 3 * m.body_jntadr[b]);
      const int before = m.body_weldid[m.body_parentid[b]];
      if (before > 0) {
        const Moving& parent = all[static_cast<std::size_t>(before)];
        own.way = parent.way + (own.anchor - parent.anchor).norm();
      }
    }
    const Vector3d at = Vector3d::Map(d->xipos + 3 * b);
    const Matrix3d axes = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>::Map(d->ximat + 9 * b);
    const Vector3d moments = Vector3d::Map(m.body_inertia + 3 * b);
    own.mass += m.body_mass[b];
    own.first += m.body_mass[b] * at;
    own.inertia +=
        axes * moments.asDiagonal() * axes.transpose() + m.body_mass[b] * point_inertia(at);
  }
  return all;
}

// [m] at which distance from its centre its mass would have its largest moment
double radius_of(const Moving& part) {
  if (part.mass < 1e-9) return 0;  // a frame between two joints
  const Matrix3d inertia = part.inertia - part.mass * point_inertia(part.center());
  const Eigen::SelfAdjointEigenSolver<Matrix3d> own(inertia, Eigen::EigenvaluesOnly);
  return std::sqrt(std::max(0., own.eigenvalues().maxCoeff()) / part.mass);
}

}  // namespace

std::string doubts_about(const mjModel& m) {
  constexpr double kSmall = 0.25;  // [m] up to it a wheel may be larger than its arm
  constexpr double kDense = 2000;  // [kg/m^3] of a cube as wide as the arm reaches
  constexpr double kFar = 3;  // [1] of the way through the joints, from a joint to a center of mass
  constexpr double kLongest = 20;         // [m]
  constexpr double kMostTurn = 8 * M_PI;  // [rad]
  constexpr double kMostWay = 10;         // [m] of a slide
  constexpr double kEndless = 1e6;        // [rad] or [m] from which on no limit is meant
  constexpr double kApart = 0.01;         // [m] wheels on a base, one beside the other, are no arm
  if (m.nv < 3) return "";
  const std::vector<Moving> parts = moving_parts(m);
  double mass = 0, reach = 0, way = 0;
  for (const Moving& p : parts) {
    mass += p.mass;
    way = std::max(way, p.way);
    reach = std::max(reach, p.way + (p.center() - p.anchor).norm());
  }
  if (way < kApart) return "";
  std::vector<std::string> all;
  for (int b = 1; b < m.nbody; ++b) {
    const Moving& p = parts[static_cast<std::size_t>(b)];
    if (const double far = (p.center() - p.anchor).norm();
        p.mass > 0 && far > kFar * std::max(way, kSmall))
      all.push_back(fmt::format("the center of mass of '{}' is {:.2g} m from its joint",
                                element_name(m, mjOBJ_BODY, b), far));
    if (const double radius = radius_of(p); radius > std::max(reach, kSmall))
      all.push_back(fmt::format("'{}' of {:.3g} kg has the inertia of something {:.2g} m wide",
                                element_name(m, mjOBJ_BODY, b), p.mass, 2 * radius));
  }
  if (mass > kDense * reach * reach * reach)
    all.push_back(fmt::format("it weighs {:.3g} kg", mass));
  if (reach > kLongest) all.push_back(fmt::format("it reaches more than {:g} m", kLongest));
  for (int j = 0; j < m.njnt; ++j) {
    const bool slides = m.jnt_type[j] == mjJNT_SLIDE;
    const mjtNum* const range = m.jnt_range + 2 * j;
    if (m.jnt_limited[j] == 0 || !(range[1] - range[0] > (slides ? kMostWay : kMostTurn)) ||
        std::max(-range[0], range[1]) > kEndless)
      continue;
    all.push_back(fmt::format(
        "joint '{}' has limits of {:.4g} and {:.4g} {}", element_name(m, mjOBJ_JOINT, j), range[0],
        range[1], slides ? "m, which may be mm: give m" : "rad, which may be degrees: give rad"));
  }
  if (all.empty()) return "";
  return one_line(fmt::format("doubtful, as the arm reaches {:.2g} m: {}; such numbers are often "
                              "placeholders, or in other units (g, mm, degrees), and torques of "
                              "motions will be wrong",
                              reach, fmt::join(all, ", ")),
                  8000);
}

}  // namespace tauext
