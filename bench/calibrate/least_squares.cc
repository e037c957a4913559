// SPDX-License-Identifier: Apache-2.0
#include "bench/calibrate/least_squares.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "bench/calibrate/residuals.h"

namespace tauext {

using Eigen::MatrixXd;
using Eigen::VectorXd;

VectorXd Fit::theta() const {
  VectorXd all(static_cast<Eigen::Index>(parameters.size()));
  for (std::size_t i = 0; i < parameters.size(); ++i)
    all[static_cast<Eigen::Index>(i)] = parameters[i].theta;
  return all;
}

Fit fit(const MatrixXd& A, const VectorXd& y, const std::vector<std::string>& names,
        const char* remedy) {
  constexpr double kLeast = 1e-100;  // in the place of a norm or a singular value of 0
  const Eigen::Index m = A.rows(), n = A.cols();
  const VectorXd norm = A.colwise().norm();
  const MatrixXd scaled = A * norm.cwiseMax(kLeast).cwiseInverse().asDiagonal();
  const Eigen::JacobiSVD<MatrixXd> svd(scaled, Eigen::ComputeThinU | Eigen::ComputeThinV);
  const VectorXd& s = svd.singularValues();
  // The norm of row i of V S^-1 is the root of the i-th diagonal element of (A^T A)^-1, A with its
  // columns scaled; its inverse is the share of column i that the others cannot imitate.
  const VectorXd root =
      (svd.matrixV() * s.cwiseMax(kLeast).cwiseInverse().asDiagonal()).rowwise().norm();
  Fit f;
  f.condition = s[0] / s[n - 1];
  if (!(f.condition < 1e6)) {
    Eigen::Index least = 0;
    root.maxCoeff(&least);
    throw std::invalid_argument(
        fmt::format("the motion cannot tell '{}' from the other terms (condition {:.1e}): {}",
                    names[static_cast<std::size_t>(least)], f.condition, remedy));
  }
  const VectorXd theta = norm.cwiseInverse().asDiagonal() * svd.solve(y);
  f.inverse = (A.transpose() * A).ldlt().solve(MatrixXd::Identity(n, n));
  f.residuals = y - A * theta;
  f.y = std::sqrt(y.squaredNorm() / static_cast<double>(m));
  f.residual = std::sqrt(f.residuals.squaredNorm() / static_cast<double>(m - n));
  const VectorXd robust = robust_errors(A, f.inverse, f.residuals);
  for (Eigen::Index i = 0; i < n; ++i) {
    f.parameters.push_back({theta[i], f.residual * root[i] / norm[i], robust[i],
                            norm[i] / std::sqrt(static_cast<double>(m)),
                            std::min(1 / root[i], 1.)});
  }
  return f;
}

VectorXd jackknife_errors(const MatrixXd& theta) {
  const auto n = static_cast<double>(theta.cols());
  const VectorXd mean = theta.rowwise().mean();
  return std::sqrt((n - 1) / n) * (theta.colwise() - mean).rowwise().norm();
}

}  // namespace tauext
