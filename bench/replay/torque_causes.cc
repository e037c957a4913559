// SPDX-License-Identifier: Apache-2.0
#include "bench/replay/torque_causes.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "bench/replay/column_reading.h"
#include "mjcf/mujoco/layout.h"

namespace tauext {
namespace {

constexpr std::size_t kMostFitted = 256;  // windows, from all of the recording
constexpr double kMinFactor = 1.25;       // [1] nearer to 1 a file's masses may err
constexpr double kAlmostAll = 0.1;    // [1] by which a multiple of gravity may differ from -1 or 1
constexpr double kMostlyNoise = 0.6;  // [1] of the windows; fewer that are independent are no noise
constexpr double kFarthest = 0.3;     // [m] of a load's center from the end effector
constexpr double kMostOffset = 0.1;   // [1] of the largest usual torque, more than a sensor's
constexpr double kLargestRotor = 3;   // [1] of the largest usual torque, at 10 rad/s^2

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using Windows = std::vector<const ArmWindow*>;

// of a cause, how much better it is than the model alone
struct Gain {
  double likelihood = 0;  // log
  double improvement =
      1;             // [1] by which the mean square gets smaller, in the joint where it does most
  VectorXd numbers;  // that were fitted; of another reading that improvement, joint by joint
};

class Causes {
 public:
  // @param offsets whether any recording may have some
  Causes(const ArmTree& arm, const WindowMaker& recording, bool offsets = true)
      : arm_(arm),
        recording_(recording),
        offsets_(offsets),
        windows_(thinned(recording.windows(), kMostFitted)) {
    for (int j = 0; j < arm.dof(); ++j) {
      Joint one;
      const VectorXd tau = each(windows_, [j](const ArmWindow& w) { return w.tau[j]; });
      one.model = each(windows_, [j](const ArmWindow& w) { return w.model[j]; });
      one.gravity = each(windows_, [j](const ArmWindow& w) { return w.gravity[j]; });
      one.rest = tau - one.model;
      one.rotor = rotor_torque(windows_, j);
      one.negligible = kNegligible * (tau.array() - tau.mean()).square().mean() + 1e-300;
      one.own = left(one, j, one.rest);
      joints_.push_back(std::move(one));
    }
  }

  std::string words() const {
    const Gain load = by_load();
    double best = load.likelihood + kSure;
    std::string words;
    const auto consider = [&](const Gain& g, auto&& in_words) {
      if (g.improvement < kMinImprovement || g.likelihood < std::max(best, kSure)) return;
      best = g.likelihood;
      words = in_words();
    };
    const double again = gravity_again();
    if (std::abs(again - 1) < kAlmostAll)
      consider(by_gravity(1), [] {
        return "tau contains the torque of gravity twice: it is added to a torque that has it "
               "already. Use [tau] in the place of [tau_without_gravity] in a map (--columns), or "
               "do not add it where tau is recorded";
      });
    if (std::abs(again + 1) < kAlmostAll)
      consider(by_gravity(-1), [] {
        return "tau does not contain the torque of gravity. If the recording has it removed, use "
               "[tau_without_gravity] in a map (--columns)";
      });
    double unit = 1;
    consider(by_unit(unit), [&] {
      return fmt::format(
          "all torques are {:.3g} times the model's: is this another unit (lbf ft: 0.738)? `gain = "
          "{:.4g}` of [tau] in a map (--columns) makes it N m",
          unit, 1 / unit);
    });
    for (int j = 0; j < arm_.dof(); ++j) consider_joint(j, consider);
    for (int b = 1; b < arm_.dof(); ++b) {
      for (int a = 0; a < b; ++a) {
        consider(by_exchange(a, b), [a, b] {
          return fmt::format(
              "q and qd of joints {} and {} fit better if they are exchanged: name the columns in "
              "a map (--columns), or set its [q]'s and [qd]'s `columns`",
              a + 1, b + 1);
        });
      }
    }
    if (words.empty() && load.likelihood < kSure) words = large_rotor();
    return words.empty() ? large_offset() : words;
  }

 private:
  template <class Consider>
  void consider_joint(int j, Consider& consider) const {
    consider(by_gravity_of(j), [j] {
      return fmt::format("tau of joint {} does not contain the torque of gravity", j + 1);
    });
    double s = 1;
    consider(by_factor(j, s), [&] {
      return fmt::format(
          "tau of joint {} is {:.3g} times the model's torque: is it in another unit? `unit` and "
          "`gain` of [tau] in a map (--columns) say so",
          j + 1, s);
    });
    consider(by_mirror(j), [j] {
      return fmt::format(
          "q, qd and tau of joint {} fit better with the other sign: `sign` of [q], [qd] and [tau] "
          "in a map (--columns) says so",
          j + 1);
    });
  }

  struct Joint {
    VectorXd rest, model, gravity, rotor;  // [N m] of each window
    double negligible = 0;                 // [(N m)^2]
    WindowFit own;                         // of the rest, by what any recording may have
  };

  WindowFit left(const Joint& of, int j, const VectorXd& y, const MatrixXd& more = {}) const {
    MatrixXd any(y.size(), offsets_ + more.cols());
    if (more.cols() > 0) any.leftCols(more.cols()) = more;
    if (offsets_) any.rightCols(1).setOnes();
    return fit(windows_, j, y, any, of.rotor);
  }

  // what a fit of joint j gains beside the model; [1] by which its mean square gets smaller
  double add(Gain& g, int j, const WindowFit& f) const {
    const Joint& of = joints_[static_cast<std::size_t>(j)];
    const double ratio = (of.own.mean_square + of.negligible) / (f.mean_square + of.negligible);
    g.likelihood += independent(ratio < 1 ? of.own.residual : f.residual) / 2 * std::log(ratio);
    g.improvement = std::max(g.improvement, ratio);
    return ratio;
  }

  // of all joints, which contain it so many times more
  Gain by_gravity(double again) const {
    Gain g;
    for (int j = 0; j < arm_.dof(); ++j) {
      const Joint& of = joints_[static_cast<std::size_t>(j)];
      add(g, j, left(of, j, of.rest - again * of.gravity));
    }
    return g;
  }

  // [1] how many times more all joints together contain it
  double gravity_again() const {
    std::vector<MatrixXd> columns;
    for (const Joint& of : joints_) columns.emplace_back(of.gravity);
    return in_common(columns).numbers[0];
  }

  Gain by_gravity_of(int j) const {
    Gain g;
    const Joint& of = joints_[static_cast<std::size_t>(j)];
    const WindowFit some = left(of, j, of.rest, of.gravity);
    if (std::abs(some.multiples[0] + 1) < kAlmostAll) add(g, j, left(of, j, of.rest + of.gravity));
    return g;
  }

  // s: of all joints; a rotor may be as much of one alone
  Gain by_unit(double& s) const {
    std::vector<MatrixXd> columns;
    for (const Joint& of : joints_) columns.emplace_back(of.model);
    s = 1 + in_common(columns).numbers[0];
    Gain g;
    if (arm_.dof() < 2 || s <= 0 || (s > 1 / kMinFactor && s < kMinFactor)) return g;
    for (int j = 0; j < arm_.dof(); ++j) {
      const Joint& of = joints_[static_cast<std::size_t>(j)];
      WindowFit f = left(of, j, of.rest - (s - 1) * of.model);
      undo_noise(f, s);
      add(g, j, f);
    }
    return g;
  }

  // s: of the torque without any rotor but the file's
  Gain by_factor(int j, double& s) const {
    Gain g;
    const Joint& of = joints_[static_cast<std::size_t>(j)];
    if (!moves(windows_)) return g;
    MatrixXd any(of.rest.size(), 2);
    any << of.model, VectorXd::Ones(of.rest.size());
    WindowFit f = fit(windows_, j, of.rest, any);
    s = 1 + f.multiples[0];
    if (s > 1 / kMinFactor && s < kMinFactor) return g;
    undo_noise(f, s);
    WindowFit with_rotor = left(of, j, of.rest, of.model);
    undo_noise(with_rotor, std::min(std::abs(s), std::abs(1 + with_rotor.multiples[0])));
    add(g, j, f.mean_square < with_rotor.mean_square ? f : with_rotor);
    return g;
  }

  // of a recording that is read otherwise; none where anything but noise is left, as masses that
  // err may look like it
  template <class Read>
  Gain by_reading(Read&& read) const {
    ArmWindows others;
    for (const ArmWindow* own : windows_) {
      MatrixXd motion = own->motion;
      ArmWindow::VectorN tau = own->tau;
      read(motion, tau);
      others.push_back(recording_.window(std::move(motion), tau));
    }
    const Windows windows = thinned(others, others.size() + 1);
    Gain g{.numbers = VectorXd(arm_.dof())};
    for (int k = 0; k < arm_.dof(); ++k) {
      const VectorXd rest =
          each(windows, [k](const ArmWindow& w) { return w.tau[k] - w.model[k]; });
      const WindowFit f =
          fit(windows, k, rest, MatrixXd::Ones(rest.size(), 1), rotor_torque(windows, k));
      if (f.mean_square > joints_[static_cast<std::size_t>(k)].negligible &&
          independent(f.residual) < kMostlyNoise * static_cast<double>(windows.size()))
        return {};
      g.numbers[k] = add(g, k, f);
    }
    return g;
  }

  // all signs of a joint, as gravity may not tell them
  Gain by_mirror(int j) const {
    return by_reading([this, j](MatrixXd& motion, ArmWindow::VectorN& tau) {
      motion.row(1 + j) *= -1;
      motion.row(1 + arm_.dof() + j) *= -1;
      tau[j] *= -1;
    });
  }

  // of two joints that move alike, and both fit better so: a load may make one of them do so
  Gain by_exchange(int a, int b) const {
    Gain g = by_reading([this, a, b](MatrixXd& motion, ArmWindow::VectorN&) {
      motion.row(1 + a).swap(motion.row(1 + b));
      motion.row(1 + arm_.dof() + a).swap(motion.row(1 + arm_.dof() + b));
    });
    if (g.numbers.size() == 0 || std::min(g.numbers[a], g.numbers[b]) < kMinImprovement) return {};
    return g;
  }

  // numbers that all joints have in common, each with its torques in these windows
  Gain in_common(const std::vector<MatrixXd>& columns) const {
    const Index n = columns.front().cols(), count = static_cast<Index>(windows_.size());
    VectorXd x = VectorXd::Zero(n);
    for (int times = 0; times < 2; ++times) {
      MatrixXd G = MatrixXd::Zero(n, n);
      VectorXd b = VectorXd::Zero(n);
      for (int j = 0; j < arm_.dof(); ++j) {
        const Joint& of = joints_[static_cast<std::size_t>(j)];
        const MatrixXd& E = columns[static_cast<std::size_t>(j)];
        MatrixXd C(count, 4);
        C << of.rotor, each(windows_, [j](const ArmWindow& w) { return w.direction[j]; }),
            each(windows_, [j](const ArmWindow& w) { return w.speed[j]; }),
            VectorXd::Constant(count, offsets_);
        const Eigen::ColPivHouseholderQR<MatrixXd> qr(C);
        const MatrixXd A = E - C * qr.solve(E);
        const VectorXd y = of.rest - C * qr.solve(of.rest);
        const double weight = 1 / (left(of, j, of.rest - E * x).mean_square + of.negligible);
        G += weight * A.transpose() * A, b += weight * A.transpose() * y;
      }
      x = G.completeOrthogonalDecomposition().solve(b);
    }
    Gain g;
    for (int j = 0; j < arm_.dof(); ++j) {
      const Joint& of = joints_[static_cast<std::size_t>(j)];
      add(g, j, left(of, j, of.rest - columns[static_cast<std::size_t>(j)] * x));
    }
    g.numbers = x;
    return g;
  }

  // [N m] by which another arm's model differs, joint by joint
  std::vector<VectorXd> differences(const WindowMaker& other) const {
    const auto count = static_cast<Index>(windows_.size());
    std::vector<VectorXd> all(joints_.size(), VectorXd(count));
    for (Index i = 0; i < count; ++i) {
      const ArmWindow& own = *windows_[static_cast<std::size_t>(i)];
      const ArmWindow w = other.window(own.motion, own.tau);
      for (std::size_t j = 0; j < joints_.size(); ++j) {
        const auto at = static_cast<Index>(j);
        all[j][i] = w.model[at] - own.model[at];
      }
    }
    return all;
  }

  // one near the end effector
  Gain by_load() const {
    constexpr double kAside = 0.1;  // [m]
    const ArmPoint& end = arm_.point(kEndEffector);
    if (end.joint < 0) return {};
    const auto count = static_cast<Index>(windows_.size());
    std::vector<MatrixXd> columns(joints_.size(), MatrixXd(count, 4));
    for (Index c = 0; c < 4; ++c) {
      Vec<3> place = end.place;
      if (c > 0) place[c - 1] += kAside;
      const WindowMaker heavier(with_mass(end.joint, place), false);
      const auto torques = differences(heavier);
      for (std::size_t j = 0; j < joints_.size(); ++j) columns[j].col(c) = torques[j];
    }
    Gain best = in_common(columns);
    const double mass = best.numbers.sum(), aside = kAside * best.numbers.tail(3).norm();
    if (mass > 0 && mass < whole_mass() && aside < kFarthest * mass) return best;
    // no load: then the best of some places that one may have
    best = Gain();
    for (Index c = 0; c < 7; ++c) {
      std::vector<MatrixXd> one;
      for (const MatrixXd& of : columns) {
        VectorXd torque = of.col(0);
        if (c > 0)
          torque += (c > 3 ? -1 : 1) * kFarthest / kAside * (of.col((c - 1) % 3 + 1) - of.col(0));
        one.emplace_back(torque);
      }
      Gain g = in_common(one);
      if (g.numbers[0] > 0 && g.numbers[0] < whole_mass() && g.likelihood > best.likelihood)
        best = std::move(g);
    }
    return best;
  }

  // [kg] more than which no arm carries
  double whole_mass() const {
    double all = 0;
    for (const TreeJoint& j : arm_.joints) all += j.mass;
    return all;
  }

  // of 1 kg
  ArmTree with_mass(int joint, const Vec<3>& place) const {
    ArmTree heavier = arm_;
    TreeJoint& body = heavier.joints[static_cast<std::size_t>(joint)];
    const double mass = body.mass + 1;
    const Vec<3> d = place - body.center;
    body.inertia += body.mass / mass * (d.squaredNorm() * Mat<3>::Identity() - d * d.transpose());
    body.center += d / mass;
    body.mass = mass;
    return heavier;
  }

  // [N m] that accelerate a joint of this kind by 10 rad/s^2
  double largest_torque(int j) const {
    double largest = 0;
    for (int k = 0; k < arm_.dof(); ++k)
      if (arm_.slides(k) == arm_.slides(j)) largest = std::max(largest, arm_.usual_torque[k]);
    return largest;
  }

  // which is none, but a unit, where gravity does not show it
  std::string large_rotor() const {
    for (int j = 0; j < arm_.dof(); ++j) {
      const Joint& of = joints_[static_cast<std::size_t>(j)];
      const double rotor = of.own.multiples[1];
      if (!(10 * rotor > kLargestRotor * largest_torque(j))) continue;
      const double without =
          fit(windows_, j, of.rest, MatrixXd::Ones(of.rest.size(), 1)).mean_square;
      if (without < kMinImprovement * (of.own.mean_square + of.negligible)) continue;
      return fmt::format(
          "tau of joint {} takes a rotor of {:.3g} {} to explain, more than the whole arm: is it "
          "in another unit? `unit` and `gain` of [tau] in a map (--columns) say so",
          j + 1, rotor, arm_.slides(j) ? "kg" : "kg m^2");
    }
    return "";
  }

  // more than sensors have, and no load makes
  std::string large_offset() const {
    const Causes without(arm_, recording_, false);
    Gain g;
    std::vector<int> joints;
    std::vector<double> offsets;
    for (int j = 0; j < arm_.dof(); ++j) {
      const WindowFit& own = joints_[static_cast<std::size_t>(j)].own;
      const double ratio = without.add(g, j, own), offset = own.multiples[0];
      if (ratio < kMinImprovement || std::abs(offset) < kMostOffset * largest_torque(j)) continue;
      joints.push_back(j + 1);
      offsets.push_back(-offset);
    }
    if (joints.empty() || g.likelihood < without.by_load().likelihood + kSure) return "";
    return fmt::format(
        "tau of {} fits if {:.3g} N m (or N) are added to it: was it set to 0 where the recording "
        "begins? `zero` of [tau] in a map (--columns) adds them",
        listed(joints), fmt::join(offsets, ", "));
  }

  const ArmTree& arm_;
  const WindowMaker& recording_;
  bool offsets_;
  Windows windows_;
  std::vector<Joint> joints_;
};

}  // namespace

std::string found_cause(const ArmTree& arm, const WindowMaker& recording) {
  if (recording.windows().size() < kFewestWindows) return "";
  return Causes(arm, recording).words();
}

}  // namespace tauext
