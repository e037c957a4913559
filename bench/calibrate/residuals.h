// SPDX-License-Identifier: Apache-2.0
/// @file
/// Whether what a least-squares fit leaves over is noise, and what its standard errors are if it is
/// not.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace tauext {

/// Ljung and Box, "On a measure of lack of fit in time series models", Biometrika 1978, over the
/// first 20 lags (a fifth of the residuals, if that is less), as standard deviations beyond white
/// noise (Wilson and Hilferty's cube root): above 3 the residuals are no noise. What was left out
/// between two residuals is passed over, here and below.
double colour(const Eigen::VectorXd& residuals);

/// Standard errors of the parameters of y = A theta, which hold for residuals of any colour and
/// variance: Newey and West, Econometrica 1987, with Bartlett's weights over as many lags as
/// Andrews, Econometrica 1991, takes for their first autocorrelation; times n / (n - k).
/// @param inverse (A^T A)^-1
Eigen::VectorXd robust_errors(const Eigen::MatrixXd& A, const Eigen::MatrixXd& inverse,
                              const Eigen::VectorXd& residuals);

/// A term that the model may lack.
struct Suspect {
  std::string name;   ///< as the term's
  double share = 0;   ///< [1] of the residuals' variance that it would explain
  double surely = 0;  ///< [1] size of its parameter, in robust standard errors
};

/// Of the columns beside the model those that explain more than 5 % of the residuals' variance, by
/// 5 standard errors or more; the one that explains most is first. Columns that the model imitates
/// to a thousandth are none.
std::vector<Suspect> suspects(const Eigen::MatrixXd& A, const Eigen::MatrixXd& inverse,
                              const Eigen::VectorXd& residuals, const Eigen::MatrixXd& columns,
                              const std::vector<std::string>& names);

}  // namespace tauext
