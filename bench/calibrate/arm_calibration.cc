// SPDX-License-Identifier: Apache-2.0
#include "bench/calibrate/arm_calibration.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
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

// what a joint's friction may have beside the terms that were asked for
constexpr JointTerm kSuspects[] = {
    {"viscous_skew (--terms)", "", "", kJointTerms[3].column},
    {"friction with the square of the speed", "", "",
     [](double qd, double, double) { return qd * std::abs(qd); }},
    {"friction that falls with the speed (Stribeck)", "", "",
     [](double qd, double slip, double) { return slip * std::exp(-std::abs(qd) / 0.1); }},
    {"friction that grows with the load", "", "",
     [](double, double slip, double rigid) { return slip * std::abs(rigid); }},
};

using Terms = std::vector<const JointTerm*>;

// the arm without what is to be found
ArmTree bare(const ArmTree& arm, const Terms& terms) {
  const auto asked = [&](auto&& which) { return std::any_of(terms.begin(), terms.end(), which); };
  const bool armature = asked([](const JointTerm*t) { return t->column == nullptr; }),
             friction = asked([](const JointTerm*t) { return t->column != nullptr; });
  ArmTree b = arm;
  for (int i = 0; i < arm.dof(); ++i) {
    const int leader = arm.leaders[static_cast<std::size_t>(i)];
    if (!arm.drho.row(leader).isApprox(MatrixXd::Identity(arm.dof(), arm.dof()).row(i)))
      throw std::invalid_argument(
          "the arm's coordinates mix its joints (motors on tendons): friction of a joint has no "
          "place in them");
    TreeJoint& j = b.joints[static_cast<std::size_t>(leader)];
    if (armature) j.armature = 0;
    if (friction) j.viscous = j.viscous_skew = j.dry = j.offset = 0;
  }
  return b;
}

// of a term over a window
double column(const JointTerm& term, const Trace& log, int joint, const Window& w, double v_s,
              double rigid) {
  if (term.column == nullptr) return mean_acceleration(log, joint, w);
  return mean_over(log, w, [&](int k) {
    const double qd = log.qd(joint, k);
    return term.column(qd, std::tanh(qd / v_s), rigid);
  });
}

Terms find_joint_terms(const std::vector<std::string>& names) {
  refuse_twice("term", names);
  Terms all;
  if (names.empty())
    for (const JointTerm& t : kJointTerms) all.push_back(&t);
  for (const std::string& name : names)
    all.push_back(
        &find_known(kJointTerms, "term", name, [](const JointTerm& j) { return j.name; }));
  return all;
}

Rows rows_of(const std::vector<Trace>& logs, const std::vector<ArmMotion>& motions, int joint,
             const Terms& terms, const Windows& w, double v_s) {
  Rows r;
  std::vector<std::pair<std::size_t, Window>> windows;  // and the log of each
  for (std::size_t l = 0; l < logs.size(); ++l)
    for (const Window& window : windows_of(logs[l], joint, w, r.left_out))
      windows.emplace_back(l, window);
  const auto m = static_cast<Index>(windows.size()), n = static_cast<Index>(terms.size());
  r.terms.resize(m, n), r.rigid.resize(m), r.measured.resize(m);
  r.others.resize(m, static_cast<Index>(std::size(kSuspects)));
  for (Index i = 0; i < m; ++i) {
    const auto& [l, window] = windows[static_cast<std::size_t>(i)];
    r.rigid[i] = motions[l].expected(joint, window);
    r.measured[i] = mean_torque(logs[l], joint, window);
    const auto of = [&, l = l, window = window](const JointTerm& t) {
      return column(t, logs[l], joint, window, v_s, r.rigid[i]);
    };
    for (Index k = 0; k < n; ++k) r.terms(i, k) = of(*terms[static_cast<std::size_t>(k)]);
    for (Index k = 0; k < r.others.cols(); ++k) r.others(i, k) = of(kSuspects[k]);
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
  constexpr double kSurely = 5;  // standard errors
  for (const CalibratedTerm& t : joint.terms) {
    if (t.name == "coulomb" && t.value < -kSurely * t.error)
      throw std::invalid_argument(fmt::format(
          "its dry friction came out as {:.3g} +- {:.2g} N m, which no joint has: is the "
          "sign of its torque or current right? `sign` in the map of columns turns it",
          t.value, t.error));
  }
  if (joint.scale < -kSurely * joint.scale_error)
    throw std::invalid_argument(
        fmt::format("its torque fits its masses by a factor of {:.3g}: the sign is wrong, which "
                    "`sign` in the map of columns turns",
                    joint.scale));
  joint.before = rms(a.gain * r.measured - r.rigid);
  joint.after = rms(left_over(r, a));
  if (joint.after > joint.torque)
    throw std::invalid_argument(fmt::format(
        "what is left over, {:.3g} N m, is more than the torque that was measured, {:.3g} N m: is "
        "this the arm of the recordings, and do their columns have the right order, units (rad, "
        "rad/s, N m or A) and signs? --columns tells them",
        joint.after, joint.torque));
  hold_out(r, names, currents, a, joint);
  if (joint.after <= 1e-6 * joint.torque) return joint;  // no noise, but the integration's error
  joint.colour = colour(a.fit.residuals);
  MatrixXd A = r.terms;
  if (currents) A.conservativeResize(Eigen::NoChange, A.cols() + 1), A << r.rigid, r.terms;
  std::vector<std::string> suspected;
  for (const JointTerm& t : kSuspects) suspected.emplace_back(t.name);
  joint.missing = suspects(A, a.fit.inverse, a.fit.residuals, r.others, suspected);
  return joint;
}

// [rad/s] over which the joint's friction is smooth, as tree_of() will have it with what was found
double slip_speed(const ArmTree& arm, int joint, const std::vector<std::string>& names,
                  const VectorXd& theta) {
  const TreeJoint& file = arm.joints[static_cast<std::size_t>(joint)];
  double dry = names == std::vector<std::string>{"armature"} ? file.dry : 0,
         armature = file.armature;
  for (std::size_t k = 0; k < names.size(); ++k) {
    const double value = std::max(theta[static_cast<Index>(k)], 0.);
    if (names[k] == "coulomb") dry = value;
    if (names[k] == "armature") armature = value;
  }
  const double mobility = arm.mobility[joint];
  return std::max(TreeJoint().v_s,
                  dry / (1 / mobility + armature - file.armature) / kQuickestFriction);
}

}  // namespace

std::string joint_name_in_file(const ArmTree& arm, int coordinate) {
  const int joint = arm.leaders[static_cast<std::size_t>(coordinate)];
  const std::string& name = arm.names[static_cast<std::size_t>(joint)];
  return name.empty() ? fmt::format("joint{}", joint + 1) : name;
}

std::vector<CalibratedJoint> calibrate_arm(const ArmTree& arm, const std::vector<Trace>& logs,
                                           const CalibrateOptions& o) {
  check_windows(o.windows);
  const Terms terms = find_joint_terms(o.terms);
  std::vector<std::string> names;
  for (const JointTerm* t : terms) names.emplace_back(t->name);
  if (logs.empty()) throw std::invalid_argument("no recording to calibrate from");
  const bool currents = logs.front().tau_is_current;
  const ArmTree without = bare(arm, terms);
  std::vector<ArmMotion> motions;
  for (const Trace& log : logs) {
    if (log.tau_is_current != currents)
      throw std::invalid_argument("some recordings have currents, and others torques");
    motions.emplace_back(without, log);
  }
  std::vector<CalibratedJoint> all;
  for (int i = 0; i < arm.dof(); ++i) {
    const auto leader = static_cast<std::size_t>(arm.leaders[static_cast<std::size_t>(i)]);
    const std::string name = joint_name_in_file(arm, i);
    try {
      Rows r = rows_of(logs, motions, i, terms, o.windows, arm.joints[leader].v_s);
      const std::size_t needed = 5 * (terms.size() + (currents ? 1 : 0));
      if (static_cast<std::size_t>(r.rigid.size()) < needed)
        throw std::invalid_argument(
            too_few(static_cast<std::size_t>(r.rigid.size()), needed, r.left_out, o.windows));
      for (int pass = 0; pass < 3; ++pass) {  // how friction slips depends on what is found
        const double v_s =
            slip_speed(arm, static_cast<int>(leader), names, answer(r, names, currents).theta);
        r = rows_of(logs, motions, i, terms, o.windows, v_s);
      }
      all.push_back(calibrated(r, names, currents));
      all.back().name = name;
    } catch (const std::invalid_argument& e) {
      throw std::invalid_argument(fmt::format("joint {} '{}': {}", i + 1, name, e.what()));
    }
  }
  return all;
}

}  // namespace tauext
