// SPDX-License-Identifier: Apache-2.0
#include "bench/calibrate/masses/mass_prior.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <stdexcept>

#include "bench/calibrate/masses/physical_fit.h"
#include "mjcf/mujoco/layout.h"

namespace tauext {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kFrame = 1e-9;  // [kg] that a frame between joints may have

// of mass m at c, with that spread of it [m^2] about c
BodyVector body_at(double m, const Vector3d& c, const Matrix3d& spread) {
  Eigen::Matrix4d P;
  P << m * (spread + c * c.transpose()), m * c, m * c.transpose(), m;
  return body_vector(P);
}

// no thinner than that of a body of 1 cm
BodyVector thick(const TreeJoint& j) {
  constexpr double kThinnest = 0.01 * 0.01 / 12, kShare = 0.01;  // [m^2], [1] of its length
  const Matrix3d I = j.inertia / j.mass;
  const Eigen::SelfAdjointEigenSolver<Matrix3d> own(
      Matrix3d(I.trace() / 2 * Matrix3d::Identity() - I));
  const double least = std::max(kThinnest, kShare * own.eigenvalues()[2]);
  const Vector3d spread = own.eigenvalues().cwiseMax(least);
  return body_at(j.mass, j.center,
                 own.eigenvectors() * spread.asDiagonal() * own.eigenvectors().transpose());
}

// [m] from a joint to the next, or to the end effector
Vector3d way_on(const ArmTree& arm, int joint) {
  Vector3d sum = Vector3d::Zero();
  int children = 0;
  for (const TreeJoint& j : arm.joints)
    if (j.parent == joint) sum += j.position, ++children;
  if (children > 0) return sum / children;
  const ArmPoint& end = arm.point(kEndEffector);
  return end.joint == joint ? end.place : sum;
}

double reach(const ArmTree& arm) {
  double length = 0;
  for (const TreeJoint& j : arm.joints) length += j.parent < 0 ? 0 : j.position.norm();
  return std::max(length, 0.1);
}

BodyVector rod(const ArmTree& arm, int joint) {
  constexpr double kDensity = 100, kThickness = 0.5, kShortest = 0.1;  // [kg/m^3], [1], [1]
  const Vector3d way = way_on(arm, joint);
  const double length = std::max(way.norm(), kShortest * reach(arm));
  const double thickness = kThickness * length;
  return body_at(kDensity * std::pow(length, 3), way / 2,
                 (way * way.transpose() + thickness * thickness * Matrix3d::Identity()) / 12);
}

}  // namespace

std::vector<MovingBody> moving_bodies(const ArmTree& arm, const std::set<std::string>& massless) {
  std::vector<MovingBody> all;
  for (std::size_t i = 0; i < arm.joints.size(); ++i) {
    const TreeJoint& j = arm.joints[i];
    if (j.mass <= kFrame) continue;  // also of a body with several joints all but the last
    const int joint = static_cast<int>(i);
    if (arm.bodies[i].empty())
      throw std::invalid_argument(
          fmt::format("the body behind joint {} '{}' has no name; give it one in the robot's file",
                      joint + 1, arm.names[i]));
    MovingBody b{arm.bodies[i], joint, arm.point(arm.bodies[i]).place};
    b.known = massless.count(b.name) == 0;
    if (b.known) b.file = body_vector(j);
    b.prior = b.known ? thick(j) : rod(arm, joint);
    all.push_back(b);
  }
  if (all.empty()) throw std::invalid_argument("no body of this arm has a mass");
  return all;
}

}  // namespace tauext
