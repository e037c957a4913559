// SPDX-License-Identifier: Apache-2.0
#include "bench/calibrate/least_squares.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace tauext {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

double autocorrelation(const VectorXd& r, Index lag) {
  const double all = r.squaredNorm();
  return all > 0 ? r.head(r.size() - lag).dot(r.tail(r.size() - lag)) / all : 0;
}

// Andrews' for an autoregression of first order, with Bartlett's weights
Index lags(const VectorXd& r) {
  const double rho = std::clamp(autocorrelation(r, 1), -0.97, 0.97);
  const double alpha = 4 * rho * rho / std::pow((1 - rho) * (1 + rho), 2);
  const auto n = static_cast<double>(r.size());
  return std::min<Index>(static_cast<Index>(std::ceil(1.1447 * std::cbrt(alpha * n))),
                         r.size() / 4);
}

constexpr double kLeast = 1e-100;  // in the place of a norm or a singular value of 0

// what Z's columns can make of A's
MatrixXd projected(const MatrixXd& A, const MatrixXd& Z) {
  const VectorXd norm = Z.colwise().norm().cwiseMax(kLeast);
  const Eigen::ColPivHouseholderQR<MatrixXd> qr(Z * norm.cwiseInverse().asDiagonal());
  const MatrixXd Q = qr.householderQ() * MatrixXd::Identity(Z.rows(), qr.rank());
  return Q * (Q.transpose() * A);
}

}  // namespace

VectorXd Fit::theta() const {
  VectorXd all(static_cast<Eigen::Index>(parameters.size()));
  for (std::size_t i = 0; i < parameters.size(); ++i)
    all[static_cast<Eigen::Index>(i)] = parameters[i].theta;
  return all;
}

Fit fit(const MatrixXd& A, const MatrixXd& Z, const VectorXd& y,
        const std::vector<std::string>& names, const char* remedy) {
  const Eigen::Index m = A.rows(), n = A.cols();
  if (n == 0) return {{}, A, MatrixXd(0, 0), y};
  if (m <= n)
    throw std::invalid_argument(fmt::format("{} windows cannot tell {} terms: {}", m, n, remedy));
  const VectorXd norm = A.colwise().norm();
  Fit f;
  f.shown = &A == &Z ? A : projected(A, Z);
  const MatrixXd scaled = f.shown * norm.cwiseMax(kLeast).cwiseInverse().asDiagonal();
  const Eigen::JacobiSVD<MatrixXd> svd(scaled, Eigen::ComputeThinU | Eigen::ComputeThinV);
  const VectorXd& s = svd.singularValues();
  // The norm of row i of V S^-1 is the root of the i-th diagonal element of the inverse, with
  // columns scaled; its inverse is the share of column i that the others cannot imitate.
  const VectorXd root =
      (svd.matrixV() * s.cwiseMax(kLeast).cwiseInverse().asDiagonal()).rowwise().norm();
  const double condition = s[0] / s[n - 1];
  if (!(condition < 1e6)) {
    Eigen::Index least = 0;
    root.maxCoeff(&least);
    throw std::invalid_argument(
        fmt::format("the motion cannot tell '{}' from the other terms (condition {:.1e}): {}",
                    names[static_cast<std::size_t>(least)], condition, remedy));
  }
  const VectorXd theta = norm.cwiseInverse().asDiagonal() * svd.solve(y);
  f.inverse = (f.shown.transpose() * f.shown).ldlt().solve(MatrixXd::Identity(n, n));
  f.residuals = y - A * theta;
  const VectorXd robust = robust_errors(f.shown, f.inverse, f.residuals);
  for (Eigen::Index i = 0; i < n; ++i) {
    f.parameters.push_back({theta[i], robust[i], norm[i] / std::sqrt(static_cast<double>(m)),
                            std::min(1 / root[i], 1.)});
  }
  return f;
}

VectorXd jackknife_errors(const MatrixXd& theta) {
  const auto n = static_cast<double>(theta.cols());
  const VectorXd mean = theta.rowwise().mean();
  return std::sqrt((n - 1) / n) * (theta.colwise() - mean).rowwise().norm();
}

VectorXd robust_errors(const MatrixXd& A, const MatrixXd& inverse, const VectorXd& r) {
  const Index n = A.rows(), k = A.cols(), L = lags(r);
  const MatrixXd scores = r.asDiagonal() * A;
  MatrixXd S = scores.transpose() * scores;
  for (Index lag = 1; lag <= L; ++lag) {
    const MatrixXd cross = scores.bottomRows(n - lag).transpose() * scores.topRows(n - lag);
    S += (1 - static_cast<double>(lag) / static_cast<double>(L + 1)) * (cross + cross.transpose());
  }
  const double small = static_cast<double>(n) / static_cast<double>(n - k);
  return (small * (inverse * S * inverse).diagonal()).cwiseMax(0).cwiseSqrt();
}

std::vector<Suspect> suspects(const MatrixXd& A, const MatrixXd& inverse, const VectorXd& r,
                              const MatrixXd& columns, const std::vector<std::string>& names) {
  std::vector<Suspect> found;
  for (Index i = 0; i < columns.cols(); ++i) {
    const VectorXd c = columns.col(i);
    const VectorXd own = c - A * (inverse * (A.transpose() * c));
    if (own.norm() <= 1e-3 * c.norm()) continue;
    const double gain = own.dot(r) / own.squaredNorm();
    const VectorXd rest = r - gain * own;
    const MatrixXd one_over = MatrixXd::Constant(1, 1, 1 / own.squaredNorm());
    const double error = robust_errors(own, one_over, rest)[0];
    const double share = 1 - rest.squaredNorm() / std::max(r.squaredNorm(), 1e-300);
    if (share < 0.05 || std::abs(gain) < 5 * error) continue;
    found.push_back({names[static_cast<std::size_t>(i)], share, std::abs(gain) / error});
  }
  std::sort(found.begin(), found.end(),
            [](const Suspect& a, const Suspect& b) { return a.share > b.share; });
  return found;
}

}  // namespace tauext
