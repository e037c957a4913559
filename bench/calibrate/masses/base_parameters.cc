// SPDX-License-Identifier: Apache-2.0
#include "bench/calibrate/masses/base_parameters.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <Eigen/SVD>
#include <cmath>
#include <cstddef>

#include "bench/calibrate/masses/physical_fit.h"
#include "mjcf/plant/coordinates.h"

namespace tauext {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// numbers between 0 and 1 that fill it evenly: multiples of square roots of primes, modulo 1
double even(int k, int dimension) {
  constexpr double kPrimes[] = {2,  3,  5,  7,  11, 13, 17, 19, 23, 29, 31, 37,
                                41, 43, 47, 53, 59, 61, 67, 71, 73, 79, 83, 89};
  const double turns = k * std::sqrt(kPrimes[dimension % 24]);
  return turns - std::floor(turns);
}

// what the numbers multiply in the torque: the momentum's change on a way with that acceleration,
// by differences of fourth order, and the rest
MatrixXd torque_rows(const BodyTerms& terms, const VectorXd& q, const VectorXd& qd,
                     const VectorXd& qdd) {
  constexpr double h = 1e-2;  // [s]
  const auto momentum = [&](double t) {
    return terms.at(q + t * qd + t * t / 2 * qdd, qd + t * qdd).momentum;
  };
  return (8 * (momentum(h) - momentum(-h)) - (momentum(2 * h) - momentum(-2 * h))) / (12 * h) +
         terms.at(q, qd).rest;
}

// torques at many states, each joint's by its size, without what a rotor or an offset of the joint
// would do there
MatrixXd seen_torques(const ArmTree& arm, const BodyTerms& terms) {
  constexpr int kStates = 100;
  const int n = arm.dof();
  const MatrixXd poses = even_poses(arm, kStates);
  MatrixXd rows(kStates * n, terms.columns());
  MatrixXd accelerations(kStates, n);
  for (int k = 0; k < kStates; ++k) {
    VectorXd qd(n), qdd(n);
    for (int i = 0; i < n; ++i) {
      qd[i] = 2 * even(k, n + i) - 1;
      accelerations(k, i) = qdd[i] = 10 * even(k, 2 * n + i) - 5;
    }
    const MatrixXd torque = torque_rows(terms, poses.col(k), qd, qdd);
    for (int i = 0; i < n; ++i) rows.row(i * kStates + k) = torque.row(i);
  }
  for (int i = 0; i < n; ++i) {
    MatrixXd own(kStates, 2);
    own << accelerations.col(i), VectorXd::Ones(kStates);
    const MatrixXd Q = own.householderQr().householderQ() * MatrixXd::Identity(kStates, 2);
    auto of_joint = rows.middleRows(i * kStates, kStates);
    of_joint -= Q * (Q.transpose() * of_joint).eval();
    if (of_joint.norm() > 0) of_joint /= of_joint.norm();  // a wrist's torques are small
  }
  return rows;
}

}  // namespace

MatrixXd even_poses(const ArmTree& arm, int poses) {
  MatrixXd q(arm.dof(), poses);
  for (int i = 0; i < arm.dof(); ++i) {
    const auto range = finite_range(arm.lower[i], arm.upper[i], arm.slides(i));
    for (int k = 0; k < poses; ++k)
      q(i, k) = range.first + (range.second - range.first) * even(k, i);
  }
  return q;
}

BaseParameters base_parameters(const ArmTree& arm, const BodyTerms& terms,
                               const std::vector<BodyVector>& bodies, const MatrixXd& information) {
  constexpr double kRounding = 1e-7;  // [1] of the largest singular value
  constexpr double kTenth = 100;      // 1 / 0.1^2
  // numbers = U z, with z in units of what the bodies have
  MatrixXd U = MatrixXd::Zero(terms.columns(), terms.columns());
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const auto at = static_cast<Index>(b) * kBodyTerms;
    const BodyVector scale = metric(bodies[b]).diagonal().cwiseSqrt().cwiseInverse();
    const Eigen::Matrix<double, kBodyTerms, kBodyTerms> scaled =
        scale.asDiagonal() * metric(bodies[b]) * scale.asDiagonal();
    U.block<kBodyTerms, kBodyTerms>(at, at) =
        scale.asDiagonal() *
        MatrixXd(scaled.llt().matrixU().solve(MatrixXd::Identity(kBodyTerms, kBodyTerms)));
  }
  const Eigen::JacobiSVD<MatrixXd> svd(seen_torques(arm, terms) * U, Eigen::ComputeThinV);
  BaseParameters found;
  const VectorXd& s = svd.singularValues();
  while (found.all < s.size() && s[found.all] > kRounding * s[0]) ++found.all;
  const MatrixXd V = svd.matrixV().leftCols(found.all);
  const Eigen::SelfAdjointEigenSolver<MatrixXd> shown(V.transpose() * U.transpose() * information *
                                                      U * V);
  found.missing = VectorXd::Zero(static_cast<Index>(bodies.size()));
  for (int i = 0; i < found.all; ++i) {
    if (shown.eigenvalues()[i] > kTenth) {
      ++found.shown;
      continue;
    }
    const VectorXd combination = V * shown.eigenvectors().col(i);
    for (Index b = 0; b < found.missing.size(); ++b)
      found.missing[b] += combination.segment<kBodyTerms>(b * kBodyTerms).squaredNorm();
  }
  return found;
}

}  // namespace tauext
