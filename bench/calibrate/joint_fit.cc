// SPDX-License-Identifier: Apache-2.0
#include "bench/calibrate/joint_fit.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "mjcf/trace/known.h"

namespace tauext {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using Rows = JointRows;
using Names = std::vector<std::string>;

// Which parameters are free: theta = (this) phi. A row of one that is held at 0 is empty; a skew of
// viscous friction that is held at +-viscous follows that.
using Free = MatrixXd;

// what a fit says: the parameters, and for currents the gain before them
struct Answer {
  Fit fit;
  VectorXd theta, errors;           // in the terms' units; one standard error, robust
  double gain = 1, gain_error = 0;  // [N m/A], or 1
};

Answer answer(const Rows& r, const Free& free, const Names& names, bool currents) {
  Answer a;
  Names columns;
  if (currents) columns.emplace_back("the drive's gain");
  for (Index j = 0; j < free.cols(); ++j) {
    Index k = 0;
    free.col(j).cwiseAbs().maxCoeff(&k);
    columns.push_back(names[static_cast<std::size_t>(k)]);
  }
  MatrixXd A(r.rigid.size(), static_cast<Index>(columns.size())), Z(A.rows(), A.cols());
  if (currents) A.col(0) = r.rigid, Z.col(0) = r.rigid_instrument;
  A.rightCols(free.cols()) = r.terms * free;
  Z.rightCols(free.cols()) = r.term_instruments * free;
  a.fit = fit(A, Z, currents ? r.measured : VectorXd(r.measured - r.rigid), columns);
  VectorXd robust(free.cols());
  for (Index j = 0; j < free.cols(); ++j)
    robust[j] = a.fit.parameters[columns.size() - robust.size() + j].robust;
  double of_gain = 0;  // [1] its relative error
  if (currents) {
    const Parameter& inverse = a.fit.parameters[0];
    a.gain = 1 / inverse.theta;
    of_gain = inverse.robust / inverse.theta;
    a.gain_error = std::abs(a.gain * of_gain);
  }
  a.theta = a.gain * free * a.fit.theta().tail(free.cols());
  a.errors = (a.gain * free.cwiseAbs() * robust).cwiseAbs2() + (of_gain * a.theta).cwiseAbs2();
  a.errors = a.errors.cwiseSqrt();
  return a;
}

// rows of all stretches but one, or of that one alone
Rows part(const Rows& r, int stretch, bool without) {
  const Index m = r.rigid.size(), from = stretch * m / kStretches,
              to = (stretch + 1) * m / kStretches;
  std::vector<Index> chosen;
  for (Index i = 0; i < m; ++i)
    if ((i >= from && i < to) != without) chosen.push_back(i);
  using Eigen::indexing::all;
  return {r.terms(chosen, all), r.term_instruments(chosen, all),
          r.rigid(chosen),      r.rigid_instrument(chosen),
          r.measured(chosen),   r.others(chosen, all)};
}

double rms(const VectorXd& v) {
  return std::sqrt(v.squaredNorm() / static_cast<double>(v.size()));
}

VectorXd left_over(const Rows& r, const Answer& a) {
  return a.gain * r.measured - r.rigid - r.terms * a.theta;
}

// the same with errors by leaving stretches out one by one, too; and what is left in these [N m]
Answer answer_held_out(const Rows& r, const Free& free, const Names& names, bool currents,
                       double& held_out) {
  Answer all = answer(r, free, names, currents);
  MatrixXd theta(all.theta.size(), kStretches), gain(1, kStretches);
  double squares = 0;
  for (int s = 0; s < kStretches; ++s) {
    const Answer a = answer(part(r, s, true), free, names, currents);
    theta.col(s) = a.theta;
    gain(0, s) = a.gain;
    squares += left_over(part(r, s, false), a).squaredNorm();
  }
  held_out = std::sqrt(squares / static_cast<double>(r.rigid.size()));
  all.errors = all.errors.cwiseMax(jackknife_errors(theta));
  if (currents) all.gain_error = std::max(all.gain_error, jackknife_errors(gain)[0]);
  return all;
}

// what a joint cannot have of each parameter: what of it is below 0, or skew beyond the friction
VectorXd beyond(const VectorXd& theta, const Names& names) {
  VectorXd much = (-theta).cwiseMax(0);
  double viscous = 0;
  for (std::size_t k = 0; k < names.size(); ++k)
    if (names[k] == "viscous") viscous = std::max(theta[static_cast<Index>(k)], 0.);
  for (std::size_t k = 0; k < names.size(); ++k) {
    double& x = much[static_cast<Index>(k)];
    if (names[k] == "offset") x = 0;
    if (names[k] == "viscous_skew")
      x = std::max(std::abs(theta[static_cast<Index>(k)]) - viscous, 0.);
  }
  return much;
}

// at 0, or a skew at +-viscous
void hold(Free& free, Index k, const Names& names, bool negative) {
  Index own = 0;
  free.row(k).cwiseAbs().maxCoeff(&own);
  if (names[static_cast<std::size_t>(k)] == "viscous_skew")
    for (std::size_t v = 0; v < names.size(); ++v)
      if (names[v] == "viscous")
        free.row(k) += (negative ? -1 : 1) * free.row(static_cast<Index>(v));
  free.middleCols(own, free.cols() - own - 1) = free.rightCols(free.cols() - own - 1).eval();
  free.conservativeResize(Eigen::NoChange, free.cols() - 1);
}

// of the terms that no joint has below 0, whatever the recordings
std::string why_never_below_0(const std::string& term) {
  if (term == "coulomb")
    return ", and no joint has less than none: is the sign of its torque or current right? `sign` "
           "in the map of columns turns it";
  if (term == "armature") return ", and no rotor has less than none";
  return "";  // friction may fall with the speed
}

// The fit with armature and friction that a joint can have: what is furthest beyond that, in its
// errors, is held, and the others are fitted again.
Answer within_bounds(const Rows& r, const Names& names, bool currents, CalibratedJoint& joint) {
  const auto n = static_cast<Index>(names.size());
  Free free = MatrixXd::Identity(n, n);
  Answer a = answer_held_out(r, free, names, currents, joint.held_out);
  joint.torque = rms(a.gain * r.measured);
  joint.unbounded = rms(left_over(r, a));
  for (std::size_t k = 0; k < names.size(); ++k) {
    const Parameter& p = a.fit.parameters[k + (currents ? 1 : 0)];
    joint.terms.push_back({names[k], 0, 0, p.excitation, p.own});
  }
  VectorXd errors = a.errors, may = VectorXd::Ones(n);
  for (;;) {
    Index k = 0;
    const VectorXd much = beyond(a.theta, names).cwiseProduct(may);
    if (much.cwiseQuotient(errors.cwiseMax(1e-300)).maxCoeff(&k) <= 0) break;
    const CalibratedTerm& term = joint.terms[static_cast<std::size_t>(k)];
    const std::string found = fmt::format(
        "{} would be {:.3g} +- {:.2g} {}", term.name, a.theta[k], errors[k],
        find_known(kJointTerms, "term", term.name, [](const JointTerm& t) { return t.name; }).unit);
    const bool matters = much[k] * term.excitation > kMatters * joint.torque;
    if (matters && much[k] > kSurely * errors[k] && !why_never_below_0(term.name).empty())
      joint.doubts.push_back(found + why_never_below_0(term.name));
    else
      joint.held.push_back(fmt::format("{}: held at {}, the others fitted again", found,
                                       term.name != "viscous_skew" ? "0"
                                       : a.theta[k] < 0            ? "-viscous"
                                                                   : "viscous"));
    hold(free, k, names, a.theta[k] < 0);
    may[k] = 0;
    a = answer_held_out(r, free, names, currents, joint.held_out);
    errors = may.cwiseProduct(a.errors) + (VectorXd::Ones(n) - may).cwiseProduct(errors);
  }
  for (Index k = 0; k < n; ++k) {
    CalibratedTerm& term = joint.terms[static_cast<std::size_t>(k)];
    term.value = a.theta[k], term.error = errors[k];
  }
  return a;
}

// [1] and its error, from a fit in which it is free
void take_scale(const Answer& a, CalibratedJoint& joint) {
  joint.scale = a.gain;
  joint.scale_error = a.gain_error;
  if ((a.gain > kMostScale || a.gain < kLeastScale) &&
      std::abs(a.gain - 1) > kSurely * a.gain_error)
    joint.doubts.push_back(
        fmt::format("its torque fits its masses by a factor of {:.3g} +- {:.2g}, which must be "
                    "within {:g} and {:g}",
                    a.gain, a.gain_error, kLeastScale, kMostScale));
}

}  // namespace

CalibratedJoint calibrated_joint(const Rows& r, const Names& names, bool currents, bool scale) {
  CalibratedJoint joint;
  joint.of_currents = currents;
  scale = scale && !currents && rms(r.rigid) >= kSeen * rms(r.measured);
  const Answer a = within_bounds(r, names, currents || scale, joint);
  joint.windows = static_cast<int>(r.rigid.size());
  joint.left_out = r.left_out;
  joint.fastest = r.fastest;
  joint.torque = rms(a.gain * r.measured);
  joint.rigid = rms(r.rigid);
  const bool seen = joint.rigid >= kSeen * joint.torque;
  if (currents || scale) {
    joint.gain = a.gain;
    joint.gain_error = a.gain_error;
    if (scale) take_scale(a, joint);
    if (currents && !seen)
      throw std::invalid_argument(fmt::format(
          "the gain of its drive cannot be seen, as its masses take {:.3g} of {:.3g} N m in these "
          "motions; `gain` in the map of columns gives that of each drive [N m/A]",
          joint.rigid, joint.torque));
  } else if (seen) {
    const auto n = static_cast<Index>(names.size());
    take_scale(answer(r, MatrixXd::Identity(n, n), names, true), joint);
  }
  joint.before = rms(a.gain * r.measured - r.rigid);
  joint.after = rms(left_over(r, a));
  if (2 * joint.after * joint.after > joint.torque * joint.torque)
    joint.doubts.push_back(fmt::format(
        "{:.3g} of {:.3g} N m are left over, more than is explained (in mean squares): was it "
        "touched? --contacts names when",
        joint.after, joint.torque));
  if (joint.after <= 1e-6 * joint.torque) return joint;  // no noise, but the integration's error
  joint.missing = suspects(a.fit.shown, a.fit.inverse, a.fit.residuals, r.others, r.suspects);
  return joint;
}

}  // namespace tauext
