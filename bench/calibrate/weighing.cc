// SPDX-License-Identifier: Apache-2.0
#include "bench/calibrate/weighing.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>

#include "bench/calibrate/arm_motion.h"
#include "bench/calibrate/joint_fit.h"
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

// the windows of some recordings, joint after joint
struct Place {
  const Trace* log;
  int joint;
  Window window;
};
std::vector<Place> places_of(const std::vector<Trace>& logs, const Windows& w) {
  constexpr std::size_t kNeeded = 40;
  std::vector<Place> all;
  int left_out = 0;
  for (int joint = 0; joint < logs.front().dof(); ++joint)
    for (const Trace& log : logs)
      for (const Window& window : windows_of(log, joint, w, left_out))
        all.push_back({&log, joint, window});
  if (all.size() < kNeeded) throw std::invalid_argument(too_few(all.size(), kNeeded, left_out, w));
  return all;
}

// [N m] what the arm takes there
VectorXd expected(const ArmTree& arm, const std::vector<Place>& places) {
  VectorXd all(static_cast<Index>(places.size()));
  std::map<const Trace*, ArmMotion> motions;
  for (std::size_t i = 0; i < places.size(); ++i) {
    const auto [log, joint, window] = places[i];
    all[static_cast<Index>(i)] =
        motions.try_emplace(log, arm, *log).first->second.expected(joint, window);
  }
  return all;
}

Fit payload_fit(const MatrixXd& A, const VectorXd& y) {
  static const std::vector<std::string> terms = {"mass", "moment along x", "moment along y",
                                                 "moment along z"};
  return fit(A, A, y, terms,
             "record one that turns the payload about more axes; an arm that moves in one plane "
             "cannot weigh it");
}

// what a unit mass at the origin takes, and unit first moments along the axes
MatrixXd by_mass_and_moments(const ArmTree& arm, int joint, const Vector3d& origin,
                             const std::vector<Place>& places) {
  const auto of_unit_mass = [&](const Vector3d& p) {
    return expected(with_point(arm, joint, origin + p, 1), places);
  };
  MatrixXd A(places.size(), 4);
  A.col(0) = of_unit_mass(Vector3d::Zero()) - expected(arm, places);
  for (int i = 0; i < 3; ++i)  // its moment of inertia is the same on both sides
    A.col(i + 1) = (of_unit_mass(Vector3d::Unit(i)) - of_unit_mass(-Vector3d::Unit(i))) / 2;
  return A;
}

// each joint counts by how well it is explained
VectorXd weights_of(const MatrixXd& A, const VectorXd& y, const std::vector<Place>& places) {
  const VectorXd left = y - A * payload_fit(A, y).theta();
  VectorXd squares = VectorXd::Zero(kMostCoordinates), count = squares;
  for (std::size_t i = 0; i < places.size(); ++i) {
    const double r = left[static_cast<Index>(i)];
    squares[places[i].joint] += r * r, count[places[i].joint] += 1;
  }
  const double least = 1e-6 * std::max(y.norm() / std::sqrt(y.size()), 1e-12);  // [N m]
  VectorXd weights(y.size());
  for (std::size_t i = 0; i < places.size(); ++i) {
    const int j = places[i].joint;
    weights[static_cast<Index>(i)] = 1 / std::max(std::sqrt(squares[j] / count[j]), least);
  }
  return weights;
}

// leaving out every tenth stretch of each joint's windows
Vec<4> spread_of(const MatrixXd& A, const VectorXd& y) {
  constexpr Index kWindows = 10;  // that follow one another
  MatrixXd theta(4, kStretches);
  for (int s = 0; s < kStretches; ++s) {
    std::vector<Index> chosen;
    for (Index i = 0; i < y.size(); ++i)
      if (i / kWindows % kStretches != s) chosen.push_back(i);
    theta.col(s) = payload_fit(A(chosen, Eigen::indexing::all), y(chosen)).theta();
  }
  return jackknife_errors(theta);
}

Weight weight_of(const ArmTree& arm, int joint, const Vector3d& origin,
                 const std::vector<Trace>& logs, const Windows& w) {
  const std::vector<Place> places = places_of(logs, w);
  const MatrixXd A = by_mass_and_moments(arm, joint, origin, places);
  const VectorXd without = expected(arm, places);
  VectorXd y = -without;
  for (std::size_t i = 0; i < places.size(); ++i)
    y[static_cast<Index>(i)] += mean_torque(*places[i].log, places[i].joint, places[i].window);
  Weight weight;
  weight.windows = static_cast<int>(places.size());
  VectorXd of_inertia = VectorXd::Zero(y.size());  // [N m] the payload's own, as that of a point
  for (int pass = 0; pass < 2; ++pass) {
    const VectorXd weights = weights_of(A, y, places), rest = y - of_inertia;
    const MatrixXd weighted = weights.asDiagonal() * A;
    const Fit f = payload_fit(weighted, weights.cwiseProduct(rest));
    const Vec<4> theta = f.theta(), spread = spread_of(weighted, weights.cwiseProduct(rest));
    const auto error = [&](int i) {
      return std::max(f.parameters[static_cast<std::size_t>(i)].robust, spread[i]);
    };
    weight.mass = theta[0];
    weight.mass_error = error(0);
    weight.moment = theta.tail<3>();
    weight.moment_error = {error(1), error(2), error(3)};
    weight.residual = std::sqrt((rest - A * theta).squaredNorm() / static_cast<double>(y.size()));
    if (!(weight.mass > 0)) break;
    const Vector3d center = origin + weight.moment / weight.mass;
    of_inertia =
        expected(with_point(arm, joint, center, weight.mass), places) - without - A * theta;
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
  w.loaded = weight_of(arm, joint, origin, loaded, windows);
  if (!empty.empty()) w.empty = weight_of(arm, joint, origin, empty, windows);
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

std::string doubt(const Weighing& w) {
  const Weight& p = w.payload;
  if (p.mass >= -kSurely * p.mass_error) return "";
  return fmt::format(
      "the payload weighs {:.3g} +- {:.2g} kg, less than nothing: {}", p.mass, p.mass_error,
      w.empty.windows > 0
          ? "are the recordings with it behind --weigh, and those without it before?"
          : "the arm's masses are too large, or the torques too small; recordings without a "
            "payload, before --weigh, take that off");
}

}  // namespace tauext
