// SPDX-License-Identifier: Apache-2.0
#include "bench/calibrate/weighing.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <stdexcept>

#include "bench/calibrate/arm_motion.h"
#include "bench/calibrate/least_squares.h"
#include "mjcf/mujoco/layout.h"

namespace tauext {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

// the arm with a point of that mass at p, from the origin of the joint's body
ArmTree with_point(const ArmTree& arm, int joint, const Vector3d& p, double mass) {
  ArmTree a = arm;
  TreeJoint& j = a.joints[static_cast<std::size_t>(joint)];
  const auto about = [](const Vector3d& r) {
    return Mat<3>(r.squaredNorm() * Mat<3>::Identity() - r * r.transpose());
  };
  const double all = j.mass + mass;
  const Vec<3> center = (j.mass * j.center + mass * p) / all;
  j.inertia += j.mass * about(j.center - center) + mass * about(p - center);
  j.mass = all;
  j.center = center;
  return a;
}

// of some recordings, joint after joint: a row for each window
struct PayloadRows {
  MatrixXd A;  // by m and m c
  VectorXd y;  // [N m] what the arm's model does not explain
  std::vector<int> joint;
  int left_out = 0;
};

// what a unit mass at the origin takes, and unit first moments along the axes
std::array<ArmTree, 8> probes(const ArmTree& arm, int joint, const Vector3d& origin) {
  std::array<ArmTree, 8> all;
  all[0] = arm;
  all[1] = with_point(arm, joint, origin, 1);
  for (int i = 0; i < 3; ++i) {
    all[2 + 2 * i] = with_point(arm, joint, origin + Vector3d::Unit(i), 1);
    all[3 + 2 * i] = with_point(arm, joint, origin - Vector3d::Unit(i), 1);
  }
  return all;
}

PayloadRows payload_rows(const std::array<ArmTree, 8>& arms, const std::vector<Trace>& logs,
                         const Windows& w) {
  PayloadRows r;
  std::vector<Eigen::Matrix<double, 1, 5>> all;
  std::vector<std::vector<ArmMotion>> motions(logs.size());
  for (std::size_t l = 0; l < logs.size(); ++l)
    for (const ArmTree& a : arms) motions[l].emplace_back(a, logs[l]);
  for (int joint = 0; joint < arms[0].dof(); ++joint) {
    for (std::size_t l = 0; l < logs.size(); ++l) {
      const std::vector<ArmMotion>& m = motions[l];
      for (const Window& window : windows_of(logs[l], joint, w, r.left_out)) {
        std::array<double, 8> f;
        for (std::size_t k = 0; k < 8; ++k) f[k] = m[k].expected(window)[joint];
        all.emplace_back();
        all.back() << f[1] - f[0], (f[2] - f[3]) / 2, (f[4] - f[5]) / 2, (f[6] - f[7]) / 2,
            m[0].measured(window)[joint] - f[0];
        r.joint.push_back(joint);
      }
    }
  }
  const auto m = static_cast<Index>(all.size());
  r.A.resize(m, 4), r.y.resize(m);
  for (Index i = 0; i < m; ++i) {
    r.A.row(i) = all[static_cast<std::size_t>(i)].head(4);
    r.y[i] = all[static_cast<std::size_t>(i)][4];
  }
  return r;
}

const std::vector<std::string>& payload_terms() {
  static const std::vector<std::string> all = {"mass", "moment along x", "moment along y",
                                               "moment along z"};
  return all;
}

// each joint counts by how well it is explained
VectorXd weights_of(const PayloadRows& r, int joints) {
  const VectorXd left = r.y - r.A * fit(r.A, r.y, payload_terms()).theta();
  VectorXd squares = VectorXd::Zero(joints), count = VectorXd::Constant(joints, 1e-9);
  for (Index i = 0; i < left.size(); ++i) {
    const int j = r.joint[static_cast<std::size_t>(i)];
    squares[j] += left[i] * left[i], count[j] += 1;
  }
  const VectorXd sigma = (squares.cwiseQuotient(count)).cwiseSqrt();
  const double least = 1e-6 * std::max(r.y.norm() / std::sqrt(left.size()), 1e-12);
  VectorXd weight(left.size());
  for (Index i = 0; i < left.size(); ++i)
    weight[i] = 1 / std::max(sigma[r.joint[static_cast<std::size_t>(i)]], least);
  return weight;
}

// leaving out every tenth stretch of each joint's windows
Vec<4> spread_of(const MatrixXd& A, const VectorXd& y) {
  constexpr Index kWindows = 10;  // that follow one another
  MatrixXd theta(4, kStretches);
  for (int s = 0; s < kStretches; ++s) {
    std::vector<Index> chosen;
    for (Index i = 0; i < y.size(); ++i)
      if (i / kWindows % kStretches != s) chosen.push_back(i);
    theta.col(s) = fit(A(chosen, Eigen::all), y(chosen), payload_terms()).theta();
  }
  return jackknife_errors(theta);
}

Weight weight_of(const std::array<ArmTree, 8>& arms, int joint, const Vector3d& origin,
                 const std::vector<Trace>& logs, const Windows& w) {
  PayloadRows r = payload_rows(arms, logs, w);
  constexpr std::size_t kNeeded = 40;
  if (r.joint.size() < kNeeded)
    throw std::invalid_argument(too_few(r.joint.size(), kNeeded, r.left_out, w));
  Weight weight;
  weight.windows = static_cast<int>(r.joint.size());
  VectorXd of_point = VectorXd::Zero(r.y.size());
  for (int pass = 0; pass < 2; ++pass) {
    const VectorXd each = weights_of(r, arms[0].dof());
    const MatrixXd A = each.asDiagonal() * r.A;
    const VectorXd y = each.asDiagonal() * (r.y - of_point);
    const Fit f = fit(A, y, payload_terms());
    const Vec<4> theta = f.theta(), spread = spread_of(A, y);
    weight.mass = theta[0];
    weight.moment = theta.tail<3>();
    const auto error = [&](int i) {
      return std::max(f.parameters[static_cast<std::size_t>(i)].robust, spread[i]);
    };
    weight.mass_error = error(0);
    for (int i = 0; i < 3; ++i) weight.moment_error[i] = error(i + 1);
    weight.residual =
        std::sqrt((r.y - of_point - r.A * theta).squaredNorm() / static_cast<double>(r.y.size()));
    if (!(weight.mass > 0)) break;
    // its inertia, as that of a point
    const Vector3d c = weight.moment / weight.mass;
    std::array<ArmTree, 8> with = arms;
    with[0] = with_point(arms[0], joint, origin + c, weight.mass);
    of_point = r.y - payload_rows(with, logs, w).y - r.A * theta;
  }
  return weight;
}

}  // namespace

Weighing weigh(const ArmTree& arm, const std::vector<Trace>& loaded,
               const std::vector<Trace>& empty, const Windows& windows) {
  check_windows(windows);
  const int joint = arm.point(kEndEffector).joint;
  Weighing w;
  w.body = arm.bodies[static_cast<std::size_t>(joint)];
  if (w.body.empty())
    throw std::invalid_argument("the body behind the last joint has no name; give it one");
  const Vector3d origin = arm.point(w.body).place;
  const std::array<ArmTree, 8> arms = probes(arm, joint, origin);
  w.loaded = weight_of(arms, joint, origin, loaded, windows);
  if (!empty.empty()) w.empty = weight_of(arms, joint, origin, empty, windows);
  w.payload.mass = w.loaded.mass - w.empty.mass;
  w.payload.moment = w.loaded.moment - w.empty.moment;
  w.payload.mass_error = std::hypot(w.loaded.mass_error, w.empty.mass_error);
  for (int i = 0; i < 3; ++i)
    w.payload.moment_error[i] = std::hypot(w.loaded.moment_error[i], w.empty.moment_error[i]);
  if (w.payload.mass > 0) {
    w.center = w.payload.moment / w.payload.mass;
    for (int i = 0; i < 3; ++i)
      w.center_error[i] =
          std::hypot(w.payload.moment_error[i], w.center[i] * w.payload.mass_error) /
          w.payload.mass;
  }
  return w;
}

}  // namespace tauext
