// SPDX-License-Identifier: Apache-2.0
#include "bench/calibrate/residuals.h"

#include <algorithm>
#include <cmath>

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

}  // namespace

double colour(const VectorXd& r) {
  const Index n = r.size(), most = std::min<Index>(20, n / 5);
  if (most < 1) return 0;
  double q = 0;
  for (Index lag = 1; lag <= most; ++lag) {
    const double rho = autocorrelation(r, lag);
    q += rho * rho / static_cast<double>(n - lag);
  }
  const auto h = static_cast<double>(most), m = static_cast<double>(n);
  const double spread = 2 / (9 * h);
  return (std::cbrt(m * (m + 2) * q / h) - (1 - spread)) / std::sqrt(spread);
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
