// SPDX-License-Identifier: Apache-2.0
/// @file
/// Least squares over numbers of bodies (body_terms.h) that bodies can have.
///
/// The numbers of a body are those of some distribution of mass where its pseudo-inertia
///     P = [ Sigma  h ; h^T  m ],   Sigma = tr(I) / 2 - I,
/// is positive definite (Wensing, Kim and Slotine, "Linear matrix inequalities for physically
/// consistent inertial parameter identification", RA-L 2018). The least value of
///     F = |R theta - r|^2 / 2 + sum over bodies of D(P | P0),
///     D(P | P0) = tr(P0^-1 P) - log det(P0^-1 P) - 4                                        (iv)
/// is one, as both are convex, and D is infinite where P is not positive definite. D does not
/// depend on the axes (Lee, Wensing and Park, "Geometric robot dynamic identification: a convex
/// programming approach", T-RO 2020). Beside residuals in units of their standard deviation it
/// weighs as much as one measurement of each body's numbers whose error is as large as they are:
/// what the recordings show is theirs, and what they do not show stays near P0.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "bench/calibrate/masses/body_terms.h"

namespace tauext {

/// |R theta - r|^2 / 2 without the constant: theta^T H theta / 2 - b^T theta. The numbers of bodies
/// stand first in theta.
struct Quadratic {
  Eigen::MatrixXd H;  ///< R^T R
  Eigen::VectorXd b;  ///< R^T r
};

/// P of a body [kg m^2, kg m, kg].
Eigen::Matrix4d pseudo_inertia(const BodyVector& body);
/// The body of that P.
BodyVector body_vector(const Eigen::Matrix4d& pseudo_inertia);

/// The second derivatives of D at P, by the numbers of the body: the square of a small change of
/// them, measured by the body itself.
Eigen::Matrix<double, kBodyTerms, kBodyTerms> metric(const BodyVector& body);

/// theta at which F is least; (iv).
/// @param prior P0 of each body
/// @throws std::runtime_error if it is not found, which rounding may bring about
Eigen::VectorXd physical_fit(const Quadratic& data, const std::vector<BodyVector>& prior);

}  // namespace tauext
