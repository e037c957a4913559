// SPDX-License-Identifier: Apache-2.0
#include "bench/calibrate/masses/window_sums.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <tuple>
#include <utility>

#include "bench/calibrate/arm_calibration.h"

namespace tauext {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kFullFriction = 4;  // [1] of the speed over which dry friction is smooth

// what the bodies' numbers multiply at the samples of a log, each computed once while it is needed
class Samples {
 public:
  Samples(const BodyTerms& bodies, const Trace& log) : bodies_(bodies), log_(log) {}

  const BodyTerms::At& at(int k) {
    const auto found = known_.find(k);
    if (found != known_.end()) return found->second;
    return known_.emplace(k, bodies_.at(log_.q.col(k), log_.qd.col(k))).first->second;
  }
  void forget_before(int k) { known_.erase(known_.begin(), known_.lower_bound(k)); }

 private:
  const BodyTerms& bodies_;
  const Trace& log_;
  std::map<int, BodyTerms::At> known_;
};

// of a window: the columns of the bodies, and their instruments, a row for each coordinate
std::pair<MatrixXd, MatrixXd> body_columns(Samples& samples, const Trace& log, const Window& w) {
  MatrixXd rest = MatrixXd::Zero(log.dof(), samples.at(w.first).rest.cols()), change = rest,
           around_it = rest;
  for (int k = w.first; k < w.second; ++k) {
    const BodyTerms::At &a = samples.at(k), &b = samples.at(k + 1);
    const double g = weight(log, w, k);
    rest += g / 2 * (a.rest + b.rest);
    change += g / (log.t[k + 1] - log.t[k]) * (b.momentum - a.momentum);
  }
  const auto [before, after] = around(log, w);
  if (before.first != before.second) {
    const auto mean = [&](const Window& part, double& t) {
      MatrixXd sum = MatrixXd::Zero(rest.rows(), rest.cols());
      for (int k = part.first; k < part.second; ++k) sum += samples.at(k).momentum, t += log.t[k];
      const double n = part.second - part.first;
      t /= n;
      return MatrixXd(sum / n);
    };
    double from = 0, to = 0;
    around_it = mean(after, to) - mean(before, from);
    around_it /= to - from;
  }
  return {rest + change, rest + around_it};
}

// the columns of a joint's own terms, and their instruments
std::pair<VectorXd, VectorXd> joint_columns(const Trace& log, int joint, const Window& w,
                                            double v_s) {
  const auto speed = [&](int k) { return log.qd(joint, k); };
  VectorXd a(kTermsOfJoint), z(kTermsOfJoint);
  for (Index i = 0; i < kTermsOfJoint; ++i) {
    const JointTerm& term = kJointTerms[i];
    if (term.column == nullptr) {
      a[i] = mean_change(log, w, speed), z[i] = change_around(log, w, speed);
      continue;
    }
    a[i] = z[i] = mean_over(
        log, w, [&](int k) { return term.column(speed(k), std::tanh(speed(k) / v_s), 0); });
  }
  return {a, z};
}

void add(WindowSums& s, const VectorXd& a, const VectorXd& z, double y) {
  s.ZZ.noalias() += z * z.transpose();
  s.ZA.noalias() += z * a.transpose();
  s.AA.noalias() += a * a.transpose();
  s.Zy += y * z, s.Ay += y * a, s.yy += y * y, ++s.windows;
}

// the windows of all logs in their order, and the joints that use each
using LogWindow = std::pair<std::size_t, Window>;
using UsedWindows = std::map<LogWindow, std::vector<int>>;

double fastest_in(const Trace& log, int joint, const Window& w) {
  return log.qd.row(joint).segment(w.first, w.second - w.first + 1).cwiseAbs().maxCoeff();
}

UsedWindows used_windows(const ArmTree& arm, const std::vector<Trace>& logs, const Windows& windows,
                         const VectorXd& slip, std::vector<JointSums>& joints) {
  constexpr std::size_t kNeeded = 5 * kTermsOfJoint;
  UsedWindows all;
  for (int i = 0; i < arm.dof(); ++i) {
    JointSums& joint = joints[static_cast<std::size_t>(i)];
    Windows faster = windows;
    std::vector<LogWindow> slow;  // stand for the others where these are too few
    int left_out_of_slow = 0;
    for (const bool first : {true, false}) {
      joint.left_out = 0;
      std::vector<LogWindow> used;
      for (std::size_t l = 0; l < logs.size(); ++l)
        for (const Window& w : windows_of(logs[l], i, faster, joint.left_out))
          used.emplace_back(l, w);
      if (used.size() < kNeeded && !first) used = slow, joint.left_out = left_out_of_slow;
      if (used.size() < kNeeded)
        throw std::invalid_argument(
            fmt::format("joint {} '{}': {}", i + 1, joint_name_in_file(arm, i),
                        too_few(used.size(), kNeeded, joint.left_out, faster)));
      if (!first) {
        for (const LogWindow& p : used) all[p].push_back(i);
        break;
      }
      slow = used, left_out_of_slow = joint.left_out;
      for (const auto& [l, w] : used)
        joint.fastest = std::max(joint.fastest, fastest_in(logs[l], i, w));
      faster.min_speed =
          std::max(faster.min_speed, std::min(kFullFriction * slip[i], joint.fastest / 4));
    }
  }
  return all;
}

}  // namespace

WindowSums::WindowSums(int n)
    : ZZ(MatrixXd::Zero(n, n)), ZA(ZZ), AA(ZZ), Zy(VectorXd::Zero(n)), Ay(Zy) {}

WindowSums& WindowSums::operator+=(const WindowSums& more) {
  ZZ += more.ZZ, ZA += more.ZA, AA += more.AA, Zy += more.Zy, Ay += more.Ay;
  yy += more.yy, windows += more.windows;
  return *this;
}

double WindowSums::residual(const VectorXd& theta) const {
  const double squares = yy - 2 * theta.dot(Ay) + theta.dot(AA * theta);
  return std::sqrt(std::max(squares, 0.) / std::max(windows, 1));
}

std::vector<JointSums> window_sums(const ArmTree& arm, const BodyTerms& bodies,
                                   const std::vector<Trace>& logs, const Windows& windows,
                                   const VectorXd& slip) {
  const int columns = bodies.columns() + kTermsOfJoint;
  std::vector<JointSums> joints(static_cast<std::size_t>(arm.dof()));
  for (JointSums& j : joints)
    j.stretches.assign(kStretches, WindowSums(columns)), j.all = WindowSums(columns);
  const UsedWindows windows_used = used_windows(arm, logs, windows, slip, joints);
  std::size_t number = 0, log = logs.size();
  std::optional<Samples> samples;
  for (const auto& [place, moving] : windows_used) {
    const auto& [l, w] = place;
    const Trace& trace = logs[l];
    if (std::exchange(log, l) != l) samples.emplace(bodies, trace);
    const Window before = around(trace, w).first;
    samples->forget_before(before.first == before.second ? w.first : before.first);
    const auto [A, Z] = body_columns(*samples, trace, w);
    const std::size_t stretch = number++ * kStretches / windows_used.size();
    for (const int i : moving) {
      JointSums& joint = joints[static_cast<std::size_t>(i)];
      const auto [a, z] = joint_columns(trace, i, w, std::min(slip[i], joint.fastest / 2));
      VectorXd row(columns), instrument(columns);
      row << A.row(i).transpose(), a;
      instrument << Z.row(i).transpose(), z;
      add(joint.stretches[stretch], row, instrument, mean_torque(trace, i, w));
    }
  }
  for (JointSums& j : joints)
    for (const WindowSums& s : j.stretches) j.all += s;
  return joints;
}

}  // namespace tauext
