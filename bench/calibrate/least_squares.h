// SPDX-License-Identifier: Apache-2.0
/// @file
/// Linear least squares, with what a fit has to say of itself: standard errors that hold if what it
/// leaves over is no noise, and which term it may lack.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace tauext {

/// Standard errors beyond which a value is no error of measurement.
inline constexpr double kSurely = 3;
/// [1] of the rms of what is fitted: a parameter that makes less of it does not matter.
inline constexpr double kMatters = 0.01;

/// A parameter and how well the motion shows it.
struct Parameter {
  double theta = 0;       ///< in the term's unit
  double robust = 0;      ///< standard error, in the same unit, whatever the residuals are
  double excitation = 0;  ///< rms of the term's column, in N m by unit of its parameter
  double own = 0;         ///< [1] share of it, as shown, that other columns cannot imitate
};

/// y = A theta + residuals, the sum of whose squares is least, or which have nothing of the
/// instruments.
struct Fit {
  std::vector<Parameter> parameters;  ///< in the order of the columns
  Eigen::MatrixXd shown;              ///< A, or what the instruments show of it
  Eigen::MatrixXd inverse;            ///< (shown^T shown)^-1
  Eigen::VectorXd residuals;          ///< in the unit of y

  Eigen::VectorXd theta() const;  ///< all parameters
};

/// Where A has noise, least squares makes its parameters too small. As many columns that have
/// none of that noise are instruments: least squares in two stages (Wooldridge, "Econometric
/// analysis of cross section and panel data", 2010, 5.2), whose errors hold likewise.
/// @param Z A, or instruments of its columns
/// @param names of A's columns, which may be none
/// @param remedy against a column that the others imitate, for the error
/// @throws std::invalid_argument for no more rows than columns, or naming the column that the
/// others imitate
Fit fit(const Eigen::MatrixXd& A, const Eigen::MatrixXd& Z, const Eigen::VectorXd& y,
        const std::vector<std::string>& names,
        const char* remedy = "record one that excites it, or leave it out (--terms)");

/// Into how many stretches recordings are cut, of which a jackknife leaves out one after the other.
inline constexpr int kStretches = 10;

/// Standard errors of parameters, a row each, from fits that each lack one stretch, a column each:
/// they see what drifts from one stretch to the next.
Eigen::VectorXd jackknife_errors(const Eigen::MatrixXd& theta);

/// Standard errors of the parameters of y = A theta, which hold for residuals of any colour and
/// variance: Newey and West, Econometrica 1987, with Bartlett's weights over as many lags as
/// Andrews, Econometrica 1991, takes for their first autocorrelation; times n / (n - k). What was
/// left out between two residuals is passed over, here and below.
/// @param inverse (A^T A)^-1, of Fit::shown where there are instruments
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
