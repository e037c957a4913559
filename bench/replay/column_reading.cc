// SPDX-License-Identifier: Apache-2.0
#include "bench/replay/column_reading.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <numeric>
#include <utility>

namespace tauext {
namespace {

constexpr std::size_t kMostCompared = 48;  // windows, from all of the recording
constexpr double kFits = 1e-3;             // [1] of mean squares, what may be left unexplained
constexpr double kKnown = 1e-4;            // [1] likewise: less is noise
constexpr double kLittle = 0.02;           // [1] of a joint's usual torque, which matters to nobody
constexpr double kNone = 1e-30;            // [(N m)^2] beside 0
constexpr double kTenTimes = 2.3;          // log of it
constexpr double kAlmostEqual = 0.1;       // log of what a later reading must be better by
constexpr double kWorthAStep = 1;          // log of what another step must be better by

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

struct Found {
  ColumnReading reading;
  VectorXd unexplained;  // Search::unexplained of it
};

// what the file may lack of each joint
enum class Beside { kFriction, kLoad, kLoadAndRotor };

class Search {
 public:
  Search(const ArmTree& arm, const WindowMaker& recording)
      : arm_(arm),
        recording_(recording),
        n_(arm.dof()),
        own_(thinned(recording.windows(), kMostCompared)) {}

  ColumnReading as_it_is() const {
    std::vector<int> order(static_cast<std::size_t>(n_));
    std::iota(order.begin(), order.end(), 0);
    const VectorXd one = VectorXd::Ones(n_);
    return {order, order, one, one, VectorXd::Zero(n_), false};
  }

  // [1] of each joint's torque, in mean squares
  VectorXd unexplained(const ColumnReading& reading, Beside beside = Beside::kFriction) const {
    ArmWindows other;
    const bool moves = is_other_motion(reading);
    other.reserve(own_.size());
    for (const ArmWindow* w : own_) other.push_back(read(*w, reading, moves));
    const auto windows = thinned(other, kMostCompared + 1);
    VectorXd share(n_);
    for (int j = 0; j < n_; ++j) {
      const VectorXd tau = each(windows, [j](const ArmWindow& w) { return w.tau[j]; });
      const VectorXd left =
          each(windows, [j](const ArmWindow& w) { return w.tau[j] - w.model[j]; });
      const MatrixXd load = MatrixXd::Ones(left.size(), beside == Beside::kFriction ? 0 : 1);
      const MatrixXd rotor =
          beside == Beside::kLoadAndRotor ? MatrixXd(rotor_torque(own_, j)) : MatrixXd();
      share[j] = fit(windows, j, left, load, rotor).mean_square / (power(tau) + little_power(j));
    }
    return share;
  }

  // whether that is explained as well as by a reading of this size: by a unit of all torques, by
  // drives' gains, or by gravity that lacks in all of them
  bool has_simpler_cause(double reading) const {
    VectorXd scaled(n_), without(n_), factors(n_);
    for (int j = 0; j < n_; ++j) {
      const VectorXd tau = each(own_, [j](const ArmWindow&w) { return w.tau[j]; }),
                     model = each(own_, [j](const ArmWindow&w) { return w.model[j]; }),
                     gravity = each(own_, [j](const ArmWindow&w) { return w.gravity[j]; });
      const double s = std::max(factor(own_, j, tau), 0.), little = little_power(j);
      factors[j] = s;
      scaled[j] = misfit(own_, j, tau - s * model) / (power(tau) + s * s * little + kNone);
      without[j] = misfit(own_, j, tau + gravity - model) / (power(tau + gravity) + little);
    }
    constexpr double kAlike = 1.5;  // [1] factors that are further apart are many, and explain more
    const bool alike = factors.maxCoeff() < kAlike * factors.minCoeff();
    return size(without) < reading + kWorthAStep ||
           size(scaled) < reading + (alike ? kWorthAStep : -kTenTimes);
  }

  static double size(const VectorXd& share) { return (share.array() + kKnown).log().sum(); }

  // all that differ from it in one thing, with zeros in so many parts of a turn
  std::vector<ColumnReading> next(const ColumnReading& from, int parts, bool exchanges) const {
    std::vector<ColumnReading> all;
    const auto with = [&](auto&& change) {
      all.push_back(from);
      change(all.back());
    };
    for (int j = 0; j < n_; ++j) {
      with([j](ColumnReading& r) { r.torque_sign[j] *= -1; });
      with([j](ColumnReading& r) { r.motion_sign[j] *= -1; });
      with([j](ColumnReading& r) { r.motion_sign[j] *= -1, r.torque_sign[j] *= -1; });
      for (int part = 1; part < parts && !arm_.slides(j) && from.zero[j] == 0; ++part)
        with([=](ColumnReading& r) {
          r.zero[j] = 2 * std::numbers::pi * std::remainder(static_cast<double>(part) / parts, 1);
        });
    }
    if (!from.degrees) with([](ColumnReading& r) { r.degrees = true; });
    for (int a = 0; a < n_ && exchanges; ++a) {
      for (int b = a + 1; b < n_; ++b) {
        const auto exchange = [a, b](std::vector<int>& order, VectorXd& sign) {
          std::swap(order[static_cast<std::size_t>(a)], order[static_cast<std::size_t>(b)]);
          std::swap(sign[a], sign[b]);
        };
        with([&](ColumnReading& r) { exchange(r.torque, r.torque_sign); });
        with([&](ColumnReading& r) { exchange(r.motion, r.motion_sign); });
        with([&](ColumnReading& r) {
          exchange(r.torque, r.torque_sign), exchange(r.motion, r.motion_sign);
        });
      }
    }
    return all;
  }

  // step by step, each the best of its kind
  Found best(const ColumnReading& own, const VectorXd& unexplained_by_own, int parts,
             bool exchanges = true) const {
    Found best{own, unexplained_by_own};
    for (int step = 0; step < n_ && (best.unexplained.array() > kFits).any(); ++step) {
      double least = size(best.unexplained) - kWorthAStep;
      Found next_one;
      for (ColumnReading& r : next(best.reading, parts, exchanges)) {
        VectorXd u = unexplained(r);
        if (!(size(u) < least)) continue;
        least = size(u) - kAlmostEqual;
        next_one = {std::move(r), std::move(u)};
      }
      if (next_one.unexplained.size() == 0) break;
      best = std::move(next_one);
    }
    for (int j = 0; j < n_; ++j)
      if (best.reading.zero[j] != 0) refine_zero(best, j, std::numbers::pi / parts);
    return best;
  }

 private:
  // one between the parts of a turn that were tried, by steps of that [rad] and less
  void refine_zero(Found& best, int j, double step) const {
    for (; step > 1e-3; step /= 2) {
      for (const double by : {-step, step}) {
        ColumnReading r = best.reading;
        r.zero[j] += by;
        VectorXd u = unexplained(r);
        if (size(u) < size(best.unexplained) - kAlmostEqual) best = {std::move(r), std::move(u)};
      }
    }
  }

  static double power(const VectorXd& y) { return y.squaredNorm() / static_cast<double>(y.size()); }
  double little_power(int j) const { return std::pow(kLittle * arm_.usual_torque[j], 2); }

  bool is_other_motion(const ColumnReading& r) const {
    const ColumnReading own = as_it_is();
    return r.motion != own.motion || r.motion_sign != own.motion_sign || r.zero != own.zero ||
           r.degrees;
  }

  ArmWindow read(const ArmWindow& w, const ColumnReading& r, bool moves) const {
    ArmWindow::VectorN tau = w.tau;
    for (int j = 0; j < n_; ++j)
      tau[j] = r.torque_sign[j] * w.tau[r.torque[static_cast<std::size_t>(j)]];
    if (!moves) return {tau, w.model, w.gravity, w.speed, w.direction, {}, {}};
    const Index samples = w.motion.cols(), step = samples > 4 && samples % 2 == 1 ? 2 : 1;
    const MatrixXd own = w.motion(Eigen::indexing::all, Eigen::seq(0, Eigen::indexing::last, step));
    MatrixXd motion = own;
    for (int j = 0; j < n_; ++j) {
      const Index from = 1 + r.motion[static_cast<std::size_t>(j)];
      const double unit = r.degrees && !arm_.slides(j) ? std::numbers::pi / 180 : 1;
      motion.row(1 + j) = (unit * r.motion_sign[j] * own.row(from)).array() + r.zero[j];
      motion.row(1 + n_ + j) = unit * r.motion_sign[j] * own.row(from + n_);
    }
    return recording_.window(std::move(motion), tau);
  }

  const ArmTree& arm_;
  const WindowMaker& recording_;
  int n_;
  std::vector<const ArmWindow*> own_;
};

// those that are not in their places, from 1
std::vector<int> moved(const std::vector<int>& order) {
  std::vector<int> all;
  for (std::size_t j = 0; j < order.size(); ++j)
    if (order[j] != static_cast<int>(j)) all.push_back(static_cast<int>(j) + 1);
  return all;
}

std::string words_of_order(const std::vector<int>& order, const char* what, const char* key) {
  const std::vector<int> joints = moved(order);
  if (joints.size() == 2)
    return fmt::format(
        "{} of joints {} and {} fit the model if they are exchanged: name the columns in a map "
        "(--columns), or set its {}",
        what, joints[0], joints[1], key);
  std::vector<int> wanted;
  for (const int j : order) wanted.push_back(j + 1);
  return fmt::format(
      "{} fit the model in the order [{}]: name the columns in a map (--columns), or set its {}",
      what, fmt::join(wanted, ", "), key);
}

bool has_other_torques(const ColumnReading& r) {
  return !moved(r.torque).empty() || (r.torque_sign.array() < 0).any();
}

std::string words(const ColumnReading& r) {
  std::vector<std::string> all;
  if (!moved(r.torque).empty() && r.torque == r.motion) {
    all.push_back(words_of_order(r.torque, "q, qd and tau", "`order`"));
  } else {
    if (!moved(r.torque).empty())
      all.push_back(words_of_order(r.torque, "tau", "[tau]'s `columns` by numbers"));
    if (!moved(r.motion).empty())
      all.push_back(words_of_order(r.motion, "q and qd", "[q]'s and [qd]'s `columns` by numbers"));
  }
  if (r.degrees)
    all.push_back("q and qd fit as degrees: set `unit` of [q] and [qd] in a map (--columns)");
  std::vector<int> torques, motions, both;
  std::vector<std::pair<int, double>> zeros;
  for (Index j = 0; j < r.zero.size(); ++j) {
    // by the recording's joint, whose sign and zero a map has before it orders them
    const auto at = static_cast<std::size_t>(j);
    const bool torque = r.torque_sign[j] < 0, motion = r.motion_sign[j] < 0;
    const bool same = torque && motion && r.torque[at] == r.motion[at];
    if (same) both.push_back(r.torque[at] + 1);
    if (torque && !same) torques.push_back(r.torque[at] + 1);
    if (motion && !same) motions.push_back(r.motion[at] + 1);
    if (r.zero[j] != 0) zeros.emplace_back(r.motion[at] + 1, r.zero[j]);
  }
  if (!torques.empty())
    all.push_back(
        fmt::format("the sign of tau of {} is reversed: set `sign` of [tau] in a map "
                    "(--columns)",
                    listed(torques)));
  if (!motions.empty())
    all.push_back(
        fmt::format("the sign of q and qd of {} is reversed: set `sign` of [q] and [qd] "
                    "in a map (--columns)",
                    listed(motions)));
  if (!both.empty())
    all.push_back(
        fmt::format("the signs of q, qd and tau of {} are reversed: set `sign` of [q], "
                    "[qd] and [tau] in a map (--columns)",
                    listed(both)));
  for (const auto& [j, zero] : zeros)
    all.push_back(
        fmt::format("q of joint {} has its zero elsewhere than the robot's file: it fits "
                    "with {:.3g} rad added, by `zero` of [q] in a map (--columns)",
                    j, zero));
  return fmt::format("{}", fmt::join(all, "; and "));
}

}  // namespace

std::string listed(const std::vector<int>& joints) {
  return fmt::format("joint{} {}", joints.size() == 1 ? "" : "s", fmt::join(joints, ", "));
}

FoundReading better_reading(const ArmTree& arm, const WindowMaker& recording) {
  const Search search(arm, recording);
  const ColumnReading own = search.as_it_is();
  const VectorXd before = search.unexplained(own);
  if ((before.array() < kFits).all()) return {};
  Found found = search.best(own, before, 4);
  const auto instead = [&found](Found other, double worse) {
    if (Search::size(other.unexplained) < Search::size(found.unexplained) + worse)
      found = std::move(other);
  };
  const auto exchanged = [&found] { return !moved(found.reading.motion).empty(); };
  if ((found.unexplained.array() > kFits).any())
    instead(search.best(own, before, 24), exchanged() ? 0 : -kTenTimes);
  if (exchanged()) instead(search.best(own, before, 24, false), kAlmostEqual);  // which is simpler
  const VectorXd& after = found.unexplained;
  const bool one_alone = ((after.array() + kKnown) < 0.1 * (before.array() + kKnown)).any(),
             all_fit = (after.array() < 0.02).all();
  if (!(Search::size(before) - Search::size(after) > kTenTimes) || !one_alone || !all_fit ||
      search.has_simpler_cause(Search::size(after)))
    return {};
  const bool other_torques = has_other_torques(found.reading);  // which no rotor looks like
  const double than_loads =
      Search::size(search.unexplained(own, other_torques ? Beside::kLoad : Beside::kLoadAndRotor)) -
      Search::size(after);
  if (than_loads < kWorthAStep && !other_torques) return {};
  return {words(found.reading), than_loads > kTenTimes};
}

}  // namespace tauext
