// SPDX-License-Identifier: Apache-2.0
#include "bench/calibrate/arm_calibration.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include "bench/calibrate/arm_motion.h"
#include "bench/calibrate/least_squares.h"
#include "mjcf/trace/known.h"

namespace tauext {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// of one joint, a row for each window
struct Rows {
  MatrixXd terms;     // what the parameters multiply
  VectorXd rigid;     // [N m] what the masses take
  VectorXd measured;  // [N m] or [A]
  MatrixXd others;    // what may be missing
  int left_out = 0;
};

constexpr const char* kOthers[] = {"viscous_skew (|qd|)", "friction with the square of the speed",
                                   "friction that falls with the speed (Stribeck)",
                                   "friction that grows with the load"};

// the arm without what is to be found, and how its joints slip (ArmTree)
ArmTree bare(const ArmTree& arm) {
  ArmTree b = arm;
  for (int i = 0; i < arm.dof(); ++i) {
    const int leader = arm.leaders[static_cast<std::size_t>(i)];
    if (!arm.drho.row(leader).isApprox(MatrixXd::Identity(arm.dof(), arm.dof()).row(i)))
      throw std::invalid_argument(
          "the arm's coordinates mix its joints (motors on tendons): friction of a joint has no "
          "place in them");
    TreeJoint& j = b.joints[static_cast<std::size_t>(leader)];
    j.armature = j.viscous = j.viscous_skew = j.dry = j.offset = 0;
  }
  return b;
}

// of the terms over a window, by the trapezium rule
VectorXd columns(const Trace& log, int joint, const Window& w, double v_s, double rigid) {
  const auto [a, b] = w;
  const double T = log.t[b] - log.t[a];
  VectorXd c = VectorXd::Zero(9);
  c[0] = (log.qd(joint, b) - log.qd(joint, a)) / T;
  for (int k = a; k <= b; ++k) {
    const double before = k > a ? log.t[k] - log.t[k - 1] : 0,
                 after = k < b ? log.t[k + 1] - log.t[k] : 0, share = (before + after) / (2 * T);
    const double qd = log.qd(joint, k), slip = std::tanh(qd / v_s);
    c[1] += share * slip;
    c[2] += share * qd;
    c[3] += share * qd * slip;
    c[5] += share * qd * std::abs(qd);
    c[6] += share * slip * std::exp(-std::abs(qd) / 0.1);
    c[7] += share * slip * std::abs(rigid);
  }
  c[4] = 1;
  return c;
}

std::vector<Index> numbers_of(const std::vector<std::string>& terms) {
  refuse_twice("term", terms);
  std::vector<Index> all;
  for (const std::string& t : terms) {
    const JointTerm& known =
        find_known(kJointTerms, "term", t, [](const JointTerm& j) { return j.name; });
    all.push_back(&known - kJointTerms);
  }
  if (all.empty()) throw std::invalid_argument("no term to calibrate");
  return all;
}

Rows rows_of(const std::vector<Trace>& logs, const std::vector<ArmMotion>& motions, int joint,
             const std::vector<Index>& terms, const Windows& w, double v_s) {
  Rows r;
  std::vector<VectorXd> all;
  std::vector<std::pair<double, double>> torques;
  for (std::size_t l = 0; l < logs.size(); ++l) {
    for (const Window& window : windows_of(logs[l], joint, w, r.left_out)) {
      torques.emplace_back(motions[l].expected(window)[joint], motions[l].measured(window)[joint]);
      all.push_back(columns(logs[l], joint, window, v_s, torques.back().first));
    }
  }
  const auto m = static_cast<Index>(all.size()), n = static_cast<Index>(terms.size());
  r.terms.resize(m, n), r.others.resize(m, 4), r.rigid.resize(m), r.measured.resize(m);
  for (Index i = 0; i < m; ++i) {
    const VectorXd& c = all[static_cast<std::size_t>(i)];
    for (Index k = 0; k < n; ++k) r.terms(i, k) = c[terms[static_cast<std::size_t>(k)]];
    r.others.row(i) << c[3], c[5], c[6], c[7];
    std::tie(r.rigid[i], r.measured[i]) = torques[static_cast<std::size_t>(i)];
  }
  return r;
}

// what a fit says: the parameters, and for currents the gain before them
struct Answer {
  Fit fit;
  VectorXd theta;   // in the terms' units
  double gain = 1;  // [N m/A], or 1
};

Answer answer(const Rows& r, const std::vector<std::string>& names, bool currents) {
  if (!currents) {
    Fit f = fit(r.terms, r.measured - r.rigid, names);
    VectorXd theta = f.theta();
    return {std::move(f), std::move(theta)};
  }
  MatrixXd A(r.terms.rows(), r.terms.cols() + 1);
  A << r.rigid, r.terms;
  std::vector<std::string> all = {"the drive's gain"};
  all.insert(all.end(), names.begin(), names.end());
  Fit f = fit(A, r.measured, all);
  const VectorXd theta = f.theta();
  return {std::move(f), theta.tail(theta.size() - 1) / theta[0], 1 / theta[0]};
}

// rows of all stretches but one, or of that one alone
Rows part(const Rows& r, int stretch, bool without) {
  const Index m = r.rigid.size(), from = stretch * m / kStretches,
              to = (stretch + 1) * m / kStretches;
  std::vector<Index> chosen;
  for (Index i = 0; i < m; ++i)
    if ((i >= from && i < to) != without) chosen.push_back(i);
  return {r.terms(chosen, Eigen::all), r.rigid(chosen), r.measured(chosen),
          r.others(chosen, Eigen::all), 0};
}

double rms(const VectorXd& v) {
  return std::sqrt(v.squaredNorm() / static_cast<double>(v.size()));
}

VectorXd left_over(const Rows& r, const Answer& a) {
  return a.gain * r.measured - r.rigid - r.terms * a.theta;
}

// errors by leaving stretches out one by one; and what is left in these
void hold_out(const Rows& r, const std::vector<std::string>& names, bool currents,
              const Answer& all, CalibratedJoint& joint) {
  MatrixXd theta(all.theta.size(), kStretches);
  MatrixXd gain(1, kStretches);
  double squares = 0;
  for (int s = 0; s < kStretches; ++s) {
    const Answer a = answer(part(r, s, true), names, currents);
    theta.col(s) = a.theta;
    gain(0, s) = a.gain;
    squares += left_over(part(r, s, false), a).squaredNorm();
  }
  joint.held_out = std::sqrt(squares / static_cast<double>(r.rigid.size()));
  const VectorXd errors = jackknife_errors(theta);
  for (Index k = 0; k < all.theta.size(); ++k) {
    CalibratedTerm& t = joint.terms[static_cast<std::size_t>(k)];
    t.error = std::max(t.error, errors[k]);
  }
  if (currents) joint.gain_error = std::max(joint.gain_error, jackknife_errors(gain)[0]);
}

// [1] and its error, from another fit in which it is free
void find_scale(const Rows& r, const std::vector<std::string>& names, CalibratedJoint& joint) {
  const Answer a = answer(r, names, true);
  const Parameter& inverse = a.fit.parameters[0];
  joint.scale = a.gain;
  joint.scale_error = std::abs(a.gain * inverse.robust / inverse.theta);
}

CalibratedJoint calibrated(const Rows& r, const std::vector<std::string>& names, bool currents) {
  const Answer a = answer(r, names, currents);
  CalibratedJoint joint;
  joint.windows = static_cast<int>(r.rigid.size());
  joint.left_out = r.left_out;
  const std::size_t first = currents ? 1 : 0;
  const double of_gain = currents ? a.fit.parameters[0].robust / a.fit.parameters[0].theta : 0;
  for (std::size_t k = 0; k < names.size(); ++k) {
    const Parameter& p = a.fit.parameters[k + first];
    const double value = a.theta[static_cast<Index>(k)];
    joint.terms.push_back(
        {names[k], value, std::hypot(a.gain * p.robust, value * of_gain), p.excitation, p.own});
  }
  joint.torque = rms(a.gain * r.measured);
  joint.rigid = rms(r.rigid);
  const bool seen = joint.rigid >= kSeen * joint.torque;
  if (currents) {
    joint.gain = a.gain;
    joint.gain_error = std::abs(a.gain * of_gain);
    if (!seen)
      throw std::invalid_argument(fmt::format(
          "the gain of its drive cannot be seen, as its masses take {:.3g} of {:.3g} N m in these "
          "motions; `gain` in the map of columns gives that of each drive [N m/A]",
          joint.rigid, joint.torque));
  } else if (seen) {
    find_scale(r, names, joint);
  }
  joint.before = rms(a.gain * r.measured - r.rigid);
  joint.after = rms(left_over(r, a));
  hold_out(r, names, currents, a, joint);
  if (joint.after <= 1e-6 * joint.torque) return joint;  // no noise, but the integration's error
  joint.colour = colour(a.fit.residuals);
  MatrixXd A = r.terms;
  if (currents) A.conservativeResize(Eigen::NoChange, A.cols() + 1), A << r.rigid, r.terms;
  joint.missing = suspects(A, a.fit.inverse, a.fit.residuals, r.others,
                           {std::begin(kOthers), std::end(kOthers)});
  return joint;
}

}  // namespace

std::vector<CalibratedJoint> calibrate_arm(const ArmTree& arm, const std::vector<Trace>& logs,
                                           const CalibrateOptions& o) {
  check_windows(o.windows);
  const std::vector<Index> terms = numbers_of(o.terms);
  if (logs.empty()) throw std::invalid_argument("no recording to calibrate from");
  const bool currents = logs.front().tau_is_current;
  const ArmTree without = bare(arm);
  std::vector<ArmMotion> motions;
  for (const Trace& log : logs) {
    if (log.tau_is_current != currents)
      throw std::invalid_argument("some recordings have currents, and others torques");
    motions.emplace_back(without, log);
  }
  std::vector<CalibratedJoint> all;
  for (int i = 0; i < arm.dof(); ++i) {
    const auto leader = static_cast<std::size_t>(arm.leaders[static_cast<std::size_t>(i)]);
    const std::string name =
        arm.names[leader].empty() ? fmt::format("{}", i + 1) : arm.names[leader];
    try {
      const Rows r = rows_of(logs, motions, i, terms, o.windows, arm.joints[leader].v_s);
      const std::size_t needed = 5 * (terms.size() + (currents ? 1 : 0));
      if (static_cast<std::size_t>(r.rigid.size()) < needed)
        throw std::invalid_argument(
            too_few(static_cast<std::size_t>(r.rigid.size()), needed, r.left_out, o.windows));
      all.push_back(calibrated(r, o.terms, currents));
      all.back().name = name;
    } catch (const std::invalid_argument& e) {
      throw std::invalid_argument(fmt::format("joint {} '{}': {}", i + 1, name, e.what()));
    }
  }
  return all;
}

}  // namespace tauext
