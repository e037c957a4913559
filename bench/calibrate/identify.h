// SPDX-License-Identifier: Apache-2.0
/// @file
/// Identifies a one-joint model that is linear in its parameters, like (36), from a recorded motion
/// without contact: section 6.1 of the paper, with standard errors.
///
/// Over a window, (3) integrates to
///     theta_1 mean(qdd) + sum_i theta_i mean(f_i(q, qd)) = mean(tau)                       (i)
/// with the weighted means of windows.h: the acceleration is made of the changes of the velocity,
/// and every other term goes through the same mean (tau as it is sampled; the f_i by the trapezium
/// rule). The terms stay in phase, and nothing is lost to a filter. Windows do not overlap. A
/// window is left out where the joint is slower than `min_speed`, where nobody knows dry friction,
/// where it is touched, or across a gap in the log.
///
/// (i) is solved by linear least squares over all windows, with an instrument for the acceleration,
/// whose noise would make the inertia too small; sigma_i^2 is s^2 (A^T A)^-1_ii with s^2
/// the residuals' variance, which holds if they are white noise. least_squares.h says whether they
/// are, what a sigma is if not, and which term is probably missing. What no term here can tell: a
/// loadcell's hysteresis looks like dry friction, and its gain like all of theta.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "bench/calibrate/least_squares.h"
#include "bench/calibrate/windows.h"
#include "mjcf/trace/trace.h"

namespace tauext {

/// A column of the regressor: what multiplies one parameter.
struct Term {
  std::string name;         ///< as the paper has it
  std::string unit;         ///< of its parameter
  std::string description;  ///< the column as a formula
  /// of q [rad], qd [rad/s]; not set: qdd
  std::function<double(double, double)> column;
};

/// The known terms: those of (36), and others of friction and of sensors.
const std::vector<Term>& terms();

/// Terms by name. @throws std::invalid_argument for an unknown one, listing the known ones
std::vector<Term> find_terms(const std::vector<std::string>& names);

/// What a log says about a model.
struct Identification {
  std::vector<Parameter> parameters;  ///< in the order of the terms
  double condition = 0;               ///< [1] of the regressor with its columns scaled to norm 1
  double torque = 0;                  ///< [N m] rms of the right side of (i)
  double residual = 0;                ///< [N m] standard deviation of (i)
  double colour = 0;                  ///< [1] of the residuals; above 3 they are no noise; 0 where
                                      ///< they are below a millionth of the torque
  std::vector<Suspect> missing;       ///< what may be missing; the likeliest first
  int windows = 0;                    ///< that were used
  int left_out = 0;                   ///< that were not
  std::vector<std::string> doubts;    ///< why these numbers are not to be used; else none
};

/// @throws std::invalid_argument for a log of several joints, too few windows, or a motion that
/// cannot tell the terms apart, naming the term
Identification identify(const Trace& log, const std::vector<Term>& terms, const Windows& w = {});

}  // namespace tauext
