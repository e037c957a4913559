// SPDX-License-Identifier: Apache-2.0
#include "mjcf/import/masses/inertia.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace tauext::detail {
namespace {

using Eigen::Matrix3d, Eigen::Vector3d;

// whether it is one, and not what some program made of 0: a micrometre from the centre
bool is_moment(double moment, double kg) {
  return moment > 1e-12 * kg;
}

// the least first, and a little within what a body can have
Vector3d balanced(const Vector3d& moments, double kg) {
  const double r = std::cbrt(kg / 4189), most = moments[2];
  Vector3d m = moments.cwiseMax(is_moment(most, kg) ? 1e-6 * most : .4 * kg * r * r);
  if (const double missing = m[2] - m[0] - m[1] + 1e-9 * most; missing > 0)
    m += missing / 3 * Vector3d(1, 1, -1);
  return m;
}

}  // namespace

MendedInertia mended(const Matrix3d& inertia, double kg) {
  const Eigen::SelfAdjointEigenSolver<Matrix3d> own(inertia);
  Matrix3d axes = own.eigenvectors();
  if (axes.determinant() < 0) axes.col(0) *= -1;
  const Vector3d& m = own.eigenvalues();
  MendedInertia out{inertia, balanced(m, kg), Eigen::Quaterniond(axes), m};
  out.change = (out.principal - m).cwiseAbs().maxCoeff() / out.principal[2];
  out.few_digits = is_moment(m[2], kg) && std::max(-m[0], m[2] - m[0] - m[1]) <= 1e-3 * m[2];
  if (out.change > 0) out.inertia = axes * out.principal.asDiagonal() * axes.transpose();
  return out;
}

std::string impossible(const std::string& body, const std::string& place, const Vector3d& moments) {
  return fmt::format("'{}' ({}) {:.4g}, {:.4g} and {:.4g}", body, place, moments[0], moments[1],
                     moments[2]);
}

std::string impossible_inertias(const std::vector<std::string>& bodies) {
  return fmt::format(
      "{} principal moments of inertia [kg m^2] that no body has (each is above the mass times "
      "(1e-6 m)^2, and at most the sum of the others; tauext-import --balance mends them): {}",
      bodies.size() == 1 ? "a link has" : fmt::format("{} links have", bodies.size()),
      fmt::join(bodies, ", "));
}

}  // namespace tauext::detail
