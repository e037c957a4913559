// SPDX-License-Identifier: Apache-2.0
#include "bench/calibrate/masses/physical_fit.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace tauext {
namespace {

using Eigen::Index;
using Eigen::Matrix4d;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// dP by each number
const std::array<Matrix4d, kBodyTerms>& directions() {
  static const std::array<Matrix4d, kBodyTerms> all = [] {
    std::array<Matrix4d, kBodyTerms> E;
    for (int k = 0; k < kBodyTerms; ++k)
      E[static_cast<std::size_t>(k)] = pseudo_inertia(BodyVector::Unit(k));
    return E;
  }();
  return all;
}

// log det P; -infinity where P is not positive definite
double log_det(const Matrix4d& P) {
  const Eigen::LLT<Matrix4d> llt(P);
  if (llt.info() != Eigen::Success) return -std::numeric_limits<double>::infinity();
  return 2 * Matrix4d(llt.matrixL()).diagonal().array().log().sum();
}

Matrix4d inverse_of_pseudo(const Matrix4d& P) {
  return P.llt().solve(Matrix4d::Identity());
}

BodyVector body_part(const VectorXd& theta, std::size_t body) {
  return theta.segment<kBodyTerms>(static_cast<Index>(body) * kBodyTerms);
}

double value(const Quadratic& data, const std::vector<Matrix4d>& prior_inverse,
             const VectorXd& theta) {
  double F = theta.dot(data.H * theta) / 2 - data.b.dot(theta);
  for (std::size_t b = 0; b < prior_inverse.size(); ++b) {
    const Matrix4d P = pseudo_inertia(body_part(theta, b));
    F += (prior_inverse[b] * P).trace() - log_det(P);
  }
  return F;
}

}  // namespace

Matrix4d pseudo_inertia(const BodyVector& n) {
  Eigen::Matrix3d I;
  I << n[4], n[7], n[8], n[7], n[5], n[9], n[8], n[9], n[6];
  Matrix4d P;
  P << I.trace() / 2 * Eigen::Matrix3d::Identity() - I, n.segment<3>(1),
      n.segment<3>(1).transpose(), n[0];
  return P;
}

BodyVector body_vector(const Matrix4d& P) {
  const Eigen::Matrix3d Sigma = P.topLeftCorner<3, 3>(),
                        I = Sigma.trace() * Eigen::Matrix3d::Identity() - Sigma;
  BodyVector n;
  n << P(3, 3), P.topRightCorner<3, 1>(), I(0, 0), I(1, 1), I(2, 2), I(0, 1), I(0, 2), I(1, 2);
  return n;
}

Eigen::Matrix<double, kBodyTerms, kBodyTerms> metric(const BodyVector& body) {
  const Matrix4d inv = inverse_of_pseudo(pseudo_inertia(body));
  std::array<Matrix4d, kBodyTerms> scaled;
  for (std::size_t k = 0; k < kBodyTerms; ++k) scaled[k] = inv * directions()[k];
  Eigen::Matrix<double, kBodyTerms, kBodyTerms> G;
  for (std::size_t k = 0; k < kBodyTerms; ++k)
    for (std::size_t l = 0; l < kBodyTerms; ++l)
      G(static_cast<Index>(k), static_cast<Index>(l)) = (scaled[k] * scaled[l]).trace();
  return G;
}

namespace {

// where F is least, from theta on: Newton's method, with steps that are halved until F falls
void physical_fit(const Quadratic& data, const std::vector<BodyVector>& prior, VectorXd& theta) {
  constexpr int kSteps = 2000;
  constexpr double kExact = 1e-14, kRounded = 1e-9;  // [1] of F that a step may still promise
  std::vector<Matrix4d> prior_inverse;
  for (const BodyVector& b : prior) prior_inverse.push_back(inverse_of_pseudo(pseudo_inertia(b)));
  double F = value(data, prior_inverse, theta);
  for (int step = 0; step < kSteps; ++step) {
    VectorXd gradient = data.H * theta - data.b;
    MatrixXd hessian = data.H;
    for (std::size_t b = 0; b < prior.size(); ++b) {
      const auto at = static_cast<Index>(b) * kBodyTerms;
      const Matrix4d pull =
          prior_inverse[b] - inverse_of_pseudo(pseudo_inertia(body_part(theta, b)));
      for (std::size_t k = 0; k < kBodyTerms; ++k)
        gradient[at + static_cast<Index>(k)] += (pull * directions()[k]).trace();
      hessian.block<kBodyTerms, kBodyTerms>(at, at) += metric(body_part(theta, b));
    }
    const VectorXd scale = hessian.diagonal().cwiseSqrt().cwiseMax(1e-150).cwiseInverse();
    const MatrixXd scaled = scale.asDiagonal() * hessian * scale.asDiagonal();
    const VectorXd down = -scale.cwiseProduct(scaled.ldlt().solve(scale.cwiseProduct(gradient)));
    const double slope = gradient.dot(down);  // minus the square of Newton's decrement
    if (-slope < kExact * (1 + std::abs(F))) return;
    double length = 1;
    for (; length > 1e-12; length /= 2) {
      const VectorXd next = theta + length * down;
      const double F_next = value(data, prior_inverse, next);
      if (!(F_next <= F + 1e-4 * length * slope)) continue;
      theta = next, F = F_next;
      break;
    }
    const bool last = length <= 1e-12 || step == kSteps - 1;  // no better number may be left
    if (last && -slope < kRounded * (1 + std::abs(F))) return;
    if (last) break;
  }
  throw std::runtime_error(
      "the masses were not found, as the numbers of these recordings are too far apart: are "
      "torques in N m, and the lengths of the robot's file in m?");
}

}  // namespace

// from little weight of the recordings to all of it: where they ask for what no body has, that is
// shorter than one way there
VectorXd physical_fit(const Quadratic& data, const std::vector<BodyVector>& prior) {
  constexpr double kFirst = 1e-9, kMore = 4;  // [1]
  VectorXd theta = VectorXd::Zero(data.b.size());
  for (std::size_t b = 0; b < prior.size(); ++b)
    theta.segment<kBodyTerms>(static_cast<Index>(b) * kBodyTerms) = prior[b];
  for (double weight = kFirst; weight < 0.5; weight *= kMore)
    physical_fit({weight * data.H, weight * data.b}, prior, theta);
  physical_fit(data, prior, theta);
  return theta;
}

}  // namespace tauext
