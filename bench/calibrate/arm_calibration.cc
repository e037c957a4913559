// SPDX-License-Identifier: Apache-2.0
#include "bench/calibrate/arm_calibration.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <stdexcept>
#include <utility>

#include "bench/calibrate/arm_motion.h"
#include "mjcf/trace/known.h"

namespace tauext {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

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

// [1] of the speed over which dry friction is smooth: above, all of it but 1e-3 acts
constexpr double kFullSlip = 4;

using Terms = std::vector<const JointTerm*>;

// the arm without what is to be found
ArmTree bare(const ArmTree& arm, const Terms& terms) {
  const auto asked = [&](auto&& which) { return std::any_of(terms.begin(), terms.end(), which); };
  const bool armature = asked([](const JointTerm*t) { return t->column == nullptr; }),
             friction = asked([](const JointTerm*t) { return t->column != nullptr; });
  require_own_joints(arm);
  ArmTree b = arm;
  for (const int leader : arm.leaders) {
    TreeJoint& j = b.joints[static_cast<std::size_t>(leader)];
    if (armature) j.armature = 0;
    if (friction) j.viscous = j.viscous_skew = j.dry = j.offset = 0;
  }
  return b;
}

// of a term over a window, where the mean acceleration is qdd
double column(const JointTerm& term, const Trace& log, int joint, const Window& w, double v_s,
              double rigid, double qdd) {
  if (term.column == nullptr) return qdd;
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

JointRows rows_of(const std::vector<Trace>& logs, const std::vector<ArmMotion>& motions, int joint,
                  const Terms& terms, const Windows& w, double v_s) {
  JointRows r;
  std::vector<std::pair<std::size_t, Window>> windows;  // and the log of each
  for (std::size_t l = 0; l < logs.size(); ++l)
    for (const Window& window : windows_of(logs[l], joint, w, r.left_out))
      windows.emplace_back(l, window);
  const auto m = static_cast<Index>(windows.size()), n = static_cast<Index>(terms.size());
  r.terms.resize(m, n), r.rigid.resize(m), r.measured.resize(m);
  r.term_instruments.resize(m, n), r.rigid_instrument.resize(m);
  r.others.resize(m, static_cast<Index>(std::size(kSuspects)));
  for (const JointTerm& t : kSuspects) r.suspects.emplace_back(t.name);
  for (Index i = 0; i < m; ++i) {
    const auto& [l, window] = windows[static_cast<std::size_t>(i)];
    for (int k = window.first; k <= window.second; ++k)
      r.fastest = std::max(r.fastest, std::abs(logs[l].qd(joint, k)));
    r.rigid[i] = motions[l].expected(joint, window);
    r.rigid_instrument[i] = motions[l].expected_around(joint, window);
    r.measured[i] = mean_torque(logs[l], joint, window);
    const auto speed = [&, l = l](int k) { return logs[l].qd(joint, k); };
    const double qdd = mean_change(logs[l], window, speed),
                 qdd_around = change_around(logs[l], window, speed);
    const auto of = [&, l = l, window = window](const JointTerm& t, double acceleration) {
      return column(t, logs[l], joint, window, v_s, r.rigid[i], acceleration);
    };
    for (Index k = 0; k < n; ++k) {
      const JointTerm& t = *terms[static_cast<std::size_t>(k)];
      r.terms(i, k) = of(t, qdd);
      r.term_instruments(i, k) = t.column == nullptr ? qdd_around : r.terms(i, k);
    }
    for (Index k = 0; k < r.others.cols(); ++k) r.others(i, k) = of(kSuspects[k], qdd);
  }
  return r;
}

// [rad/s] over which the joint's friction is smooth, as tree_of() will have it with what was found
double slip_speed(const ArmTree& arm, int joint, const std::vector<CalibratedTerm>& terms) {
  const TreeJoint& file = arm.joints[static_cast<std::size_t>(joint)];
  double dry = terms.size() == 1 && terms[0].name == "armature" ? file.dry : 0,
         armature = file.armature;
  for (const CalibratedTerm& t : terms) {
    if (t.name == "coulomb") dry = t.value;
    if (t.name == "armature") armature = t.value;
  }
  const double mobility = arm.mobility[joint];
  return std::max(TreeJoint().v_s,
                  dry / (1 / mobility + armature - file.armature) / kQuickestFriction);
}

// no joint's scale is seen, though the arm was lifted as much as it can be
void doubt_units(const ArmTree& arm, std::vector<CalibratedJoint>& joints) {
  constexpr double kFriction = 50;  // [1] of what the masses take, that no friction is
  for (const CalibratedJoint& j : joints)
    if (j.scale != 0 || j.gain != 0) return;
  for (std::size_t i = 0; i < joints.size(); ++i) {
    CalibratedJoint& j = joints[i];
    const bool lifted = j.rigid > kSeen * arm.usual_torque[static_cast<Index>(i)];
    if (lifted && j.torque > kFriction * j.rigid)
      j.doubts.push_back(
          fmt::format("its masses take {:.3g} N m, and {:.3g} N m were measured: are they N m?",
                      j.rigid, j.torque));
  }
}

}  // namespace

std::string joint_name_in_file(const ArmTree& arm, int coordinate) {
  const int joint = arm.leaders[static_cast<std::size_t>(coordinate)];
  const std::string& name = arm.names[static_cast<std::size_t>(joint)];
  return name.empty() ? fmt::format("joint{}", joint + 1) : name;
}

void require_own_joints(const ArmTree& arm) {
  for (int i = 0; i < arm.dof(); ++i) {
    const int leader = arm.leaders[static_cast<std::size_t>(i)];
    if (!arm.drho.row(leader).isApprox(MatrixXd::Identity(arm.dof(), arm.dof()).row(i)))
      throw std::invalid_argument(
          "the arm's coordinates mix its joints (motors on tendons): friction of a joint has no "
          "place in them");
  }
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
  std::vector<std::string> errors;  // of the joints
  for (int i = 0; i < arm.dof(); ++i) {
    const auto leader = static_cast<std::size_t>(arm.leaders[static_cast<std::size_t>(i)]);
    const std::string name = joint_name_in_file(arm, i);
    try {
      JointRows r = rows_of(logs, motions, i, terms, o.windows, arm.joints[leader].v_s);
      const std::size_t needed = 5 * (terms.size() + (currents ? 1 : 0));
      const auto usable = [](const JointRows& rows) {
        return static_cast<std::size_t>(rows.rigid.size());
      };
      if (usable(r) < needed)
        throw std::invalid_argument(too_few(usable(r), needed, r.left_out, o.windows));
      for (int pass = 0; pass < 3; ++pass) {  // how friction slips depends on what is found
        const double slip = slip_speed(arm, static_cast<int>(leader),
                                       calibrated_joint(r, names, currents, o.scale).terms);
        // smooth over more than it moves, dry friction would be viscous friction
        Windows faster = o.windows;
        faster.min_speed = std::max(faster.min_speed, std::min(kFullSlip * slip, r.fastest / 4));
        const double v_s = std::min(slip, r.fastest / 2);
        JointRows fast = rows_of(logs, motions, i, terms, faster, v_s);
        r = usable(fast) < needed ? rows_of(logs, motions, i, terms, o.windows, v_s)
                                  : std::move(fast);
      }
      CalibratedJoint joint = calibrated_joint(r, names, currents, o.scale);
      joint.slip = slip_speed(arm, static_cast<int>(leader), joint.terms);
      joint.name = name;
      for (const Trace& log : logs)
        joint.largest = std::max(joint.largest, (joint.gain == 0 ? 1 : std::abs(joint.gain)) *
                                                    log.tau.row(i).cwiseAbs().maxCoeff());
      all.push_back(std::move(joint));
    } catch (const std::invalid_argument& e) {
      errors.push_back(fmt::format("joint {} '{}': {}", i + 1, name, e.what()));
    }
  }
  if (!errors.empty()) throw std::invalid_argument(fmt::format("{}", fmt::join(errors, "; ")));
  doubt_units(arm, all);
  return all;
}

}  // namespace tauext
