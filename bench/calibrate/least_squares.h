// SPDX-License-Identifier: Apache-2.0
/// @file
/// Linear least squares, with what a fit has to say of itself.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace tauext {

/// A parameter and how well the motion shows it.
struct Parameter {
  double theta = 0;       ///< in the term's unit
  double sigma = 0;       ///< standard error, in the same unit, if the residuals are white
  double robust = 0;      ///< standard error whatever they are
  double excitation = 0;  ///< rms of the term's column, in N m by unit of its parameter
  double own = 0;         ///< [1] share of the column that the others cannot imitate, 0 to 1
};

/// y = A theta + residuals, the sum of whose squares is least.
struct Fit {
  std::vector<Parameter> parameters;  ///< in the order of the columns
  Eigen::MatrixXd inverse;            ///< (A^T A)^-1
  Eigen::VectorXd residuals;          ///< in the unit of y
  double condition = 0;               ///< [1] of A with its columns scaled to norm 1
  double y = 0;                       ///< rms of y
  double residual = 0;                ///< standard deviation of the residuals

  Eigen::VectorXd theta() const;  ///< all parameters
};

/// @param names of A's columns
/// @param remedy against a column that the others imitate, for the error
/// @throws std::invalid_argument naming the column that the others imitate
Fit fit(const Eigen::MatrixXd& A, const Eigen::VectorXd& y, const std::vector<std::string>& names,
        const char* remedy = "record one that excites it, or leave it out (--terms)");

/// Into how many stretches recordings are cut, of which a jackknife leaves out one after the other.
inline constexpr int kStretches = 10;

/// Standard errors of parameters, a row each, from fits that each lack one stretch, a column each:
/// they see what drifts from one stretch to the next.
Eigen::VectorXd jackknife_errors(const Eigen::MatrixXd& theta);

}  // namespace tauext
