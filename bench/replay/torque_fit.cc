// SPDX-License-Identifier: Apache-2.0
#include "bench/replay/torque_fit.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <utility>

#include "mjcf/trace/printable.h"

namespace tauext {
namespace {

constexpr double kWindow = 0.1, kStep = 0.01, kGap = 0.25;  // [s]
constexpr std::size_t kMaxWindows = 4096, kMinWindows = 10;
constexpr double kMinMisfit = 0.1;        // [1] of the model's mean square
constexpr double kMinOrderMisfit = 1e-4;  // [1] likewise, where joints are exchanged
constexpr double kMaxRatio = 0.1;         // [1] of mean squares: what a cause may leave unexplained
constexpr double kMaxSpreadOfGains = 1.5;  // [1] of drives that are in one arm
constexpr double kMinVariation = 1e-4;     // [1] of mean squares: less is one pose
constexpr double kMinTorqueShare = 0.05;   // [1] of a joint's usual torque, which it has to carry
constexpr double kFullSlip = 0.01;         // [rad/s] at which dry friction acts
constexpr double kMoving = 0.5;            // [1] of the time that a joint moves one way
constexpr double kStiction = 1.2;          // [1] of its dry friction
constexpr double kSame = 1.02;             // [1] of factors that one unit has, and no masses
constexpr double kMinUnit = 1.1;           // [1] and whose factor is further from 1
constexpr double kMaxRatioOfUnit = 0.01;   // [1] of mean squares, likewise

enum Rate { kRest, kGravityTorque, kSpeed, kDirection };  // of a sample, by column

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

std::string listed(const std::vector<int>& joints) {
  return fmt::format("joint{} {}", joints.size() == 1 ? "" : "s", fmt::join(joints, ", "));
}

// y - C x, where the last two of x are friction, which is not below 0
VectorXd rest_of(const MatrixXd& C, const VectorXd& y, const MatrixXd& all_C, const VectorXd& all) {
  const Index free = C.cols() - 2;
  VectorXd best = all;
  double least = std::numeric_limits<double>::infinity();
  for (const auto& friction : {std::vector<Index>{free, free + 1}, {free}, {free + 1}, {}}) {
    std::vector<Index> columns(static_cast<std::size_t>(free));
    std::iota(columns.begin(), columns.end(), 0);
    columns.insert(columns.end(), friction.begin(), friction.end());
    if (columns.empty()) {
      if (y.squaredNorm() < least) best = all;
      continue;
    }
    const MatrixXd some = C(Eigen::indexing::all, columns);
    const VectorXd x = some.colPivHouseholderQr().solve(y);
    const double misses = (y - some * x).squaredNorm();
    if ((x.tail(static_cast<Index>(friction.size())).array() < 0).any() || !(misses < least))
      continue;
    least = misses;
    best = all - all_C(Eigen::indexing::all, columns) * x;
  }
  return best;
}

std::vector<Index> best_fifths(const VectorXd& rest) {
  std::vector<Index> order(static_cast<std::size_t>(rest.size()));
  std::iota(order.begin(), order.end(), 0);
  const std::size_t kept = order.size() - order.size() / 5;
  std::nth_element(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(kept) - 1,
                   order.end(),
                   [&](Index i, Index k) { return std::abs(rest[i]) < std::abs(rest[k]); });
  order.resize(kept);
  return order;
}

// the mean square of of(window) [N m], without the worst fifth, and without what friction of joint
// j explains, and a constant load
template <class Windows, class Of>
double misfit(const Windows& windows, int j, Of of, bool load = false) {
  if (windows.empty()) return 0;
  const auto m = static_cast<Index>(windows.size());
  MatrixXd C = MatrixXd::Ones(m, load ? 3 : 2);
  VectorXd y(m);
  for (Index i = 0; i < m; ++i) {
    const auto& w = *windows[static_cast<std::size_t>(i)];
    y[i] = of(w);
    C.row(i).tail(2) << w.direction[j], w.speed[j];
  }
  const auto kept = best_fifths(rest_of(C, y, C, y));
  const VectorXd rest = rest_of(C(kept, Eigen::indexing::all), y(kept), C, y);
  return rest(best_fifths(rest)).squaredNorm() / static_cast<double>(kept.size());
}

template <class Windows, class Of>
double mean_square(const Windows& windows, Of of) {
  double sum = 0;
  for (const auto* w : windows) sum += std::pow(of(*w), 2);
  return sum / static_cast<double>(windows.size());
}

// by which of(window) is the model's torque of joint j, with any friction
template <class Windows, class Of>
double factor(const Windows& windows, int j, Of of) {
  MatrixXd C(static_cast<Index>(windows.size()), 3);
  VectorXd y(C.rows());
  for (Index i = 0; i < C.rows(); ++i) {
    const auto& w = *windows[static_cast<std::size_t>(i)];
    y[i] = of(w);
    C.row(i) << w.model[j], w.direction[j], w.speed[j];
  }
  const VectorXd first = C.colPivHouseholderQr().solve(y);
  const auto kept = best_fifths(y - C * first);
  return MatrixXd(C(kept, Eigen::indexing::all)).colPivHouseholderQr().solve(y(kept))[0];
}

}  // namespace

TorqueFit::TorqueFit(const ArmTree& arm, bool at_instants, bool gravity_added)
    : arm_(arm),
      model_(detail::filled<TiedTree>(arm)),
      at_instants_(at_instants),
      gravity_added_(gravity_added),
      n_(arm.dof()) {}

TorqueFit::ModelSample TorqueFit::sample_of(const Sample& y) const {
  ModelSample at;
  VectorN qd = VectorN::Zero();
  at.t = y.t, at.q.setZero();
  at.q.head(n_) = y.q, qd.head(n_) = y.qd;
  const auto d = model_.momentum_dynamics(at.q, qd);
  at.momentum = d.B * qd;
  at.rates.col(kRest) = model_.friction(qd) - d.bias;
  at.rates.col(kGravityTorque) = model_.gravity(at.q);
  at.rates.col(kSpeed) = qd;
  at.rates.col(kDirection) = (qd / kFullSlip).array().tanh();
  return at;
}

void TorqueFit::begin(const Sample& y) {
  begun_ = true;
  first_ = newest_ = sample_of(y);
  tau_.setZero(), rates_.setZero();
}

void TorqueFit::take(const Sample& y, bool contact, const Eigen::VectorXd& tau_ext) {
  const double h = y.t - t_;
  Eigen::VectorXd tau = y.tau;
  if (tau_ext.size() > 0) tau -= tau_ext;
  const bool usable = y.q.allFinite() && y.qd.allFinite() && tau.allFinite() && !contact;
  const bool goes_on = usable && begun_ && h > 0 && h <= kGap;
  if (goes_on) tau_.head(n_) += h * (at_instants_ ? Eigen::VectorXd((torque_ + tau) / 2) : torque_);
  t_ = y.t, torque_ = std::move(tau);
  if (!goes_on) {
    begun_ = false;
    if (usable) begin(y);
    return;
  }
  if (y.t - newest_.t < kStep * (1 - 1e-6)) return;
  const ModelSample at = sample_of(y);
  rates_ += (at.t - newest_.t) / 2 * (at.rates + newest_.rates);
  newest_ = at;
  if (at.t - first_.t >= kWindow * (1 - 1e-6)) close(at);
}

void TorqueFit::take(const Trace& log) {
  for (int k = 0; k < log.size(); ++k)
    take({log.t[static_cast<std::size_t>(k)], log.q.col(k), log.qd.col(k), log.tau.col(k)},
         !log.contact.empty() && log.contact[static_cast<std::size_t>(k)] != 0,
         log.has_truth() ? Eigen::VectorXd(log.tau_ext.col(k)) : Eigen::VectorXd());
  begun_ = false;
}

void TorqueFit::close(const ModelSample& at) {
  const double T = at.t - first_.t;
  if (count_++ % every_ == 0)
    windows_.push_back({tau_ / T, (at.momentum - first_.momentum + rates_.col(kRest)) / T,
                        rates_.col(kGravityTorque) / T, rates_.col(kSpeed) / T,
                        rates_.col(kDirection) / T, (at.q + first_.q) / 2});
  if (windows_.size() == kMaxWindows) {
    for (std::size_t i = 0; 2 * i < windows_.size(); ++i) windows_[i] = windows_[2 * i];
    windows_.resize(kMaxWindows / 2);
    every_ *= 2;
  }
  first_ = at;
  tau_.setZero(), rates_.setZero();
}

// at most 512, from all of the recording
TorqueFit::Windows TorqueFit::thinned() const {
  Windows some;
  for (std::size_t i = 0; i < windows_.size(); i += 1 + windows_.size() / 512)
    some.push_back(&windows_[i]);
  return some;
}

// those in which a joint carries something, and hardly more than that
TorqueFit::Windows TorqueFit::slow(int j) const {
  const auto leader = static_cast<std::size_t>(arm_.leaders[static_cast<std::size_t>(j)]);
  const double stiction = kStiction * arm_.joints[leader].dry;
  Windows some;
  for (const WindowMean& w : windows_) {
    const double g = std::abs(w.gravity[j]);
    // at rest dry friction may take as much
    if (std::abs(w.direction[j]) < kMoving && std::abs(w.tau[j] - w.model[j]) < stiction) continue;
    if (g > kMinTorqueShare * arm_.usual_torque[j] && std::abs(w.model[j] - w.gravity[j]) < 0.2 * g)
      some.push_back(&w);
  }
  return some;
}

// those that carry something, in slow poses
std::vector<TorqueFit::SlowJoint> TorqueFit::slow_joints() const {
  std::vector<SlowJoint> all;
  for (int j = 0; j < n_; ++j) {
    const Windows windows = slow(j);
    if (windows.size() < kMinWindows) continue;
    const auto left = [j](const WindowMean& w) { return w.tau[j] - w.model[j]; };
    const auto measured = [j](const WindowMean& w) { return w.tau[j]; };
    SlowJoint fit{.number = j + 1, .factor = factor(windows, j, measured)};
    const double s = fit.factor;
    fit.power = mean_square(windows, [j](const WindowMean& w) { return w.model[j]; });
    fit.residual = misfit(windows, j, left);
    fit.by_factor = s * s * misfit(windows, j, [j, s](const WindowMean& w) {
                      return w.tau[j] / s - w.model[j];
                    });
    fit.without_gravity =
        misfit(windows, j, [&](const WindowMean& w) { return left(w) + w.gravity[j]; });
    fit.without_model = misfit(windows, j, measured);
    // of a load's residual, how much a better cause may leave: nothing where the pose is one
    const double load = misfit(windows, j, left, true);
    fit.by_load = load > kMinVariation * fit.residual ? kMaxRatio * load : 0;
    all.push_back(fit);
  }
  return all;
}

// without gravity, or in another unit, in joints that carry most of what is carried
TorqueFit::Cause TorqueFit::by_gravity() const {
  const std::vector<SlowJoint> joints = slow_joints();
  std::vector<int> without, scaled;
  std::vector<double> factors;
  bool without_varied = false, scaled_varied = true;
  double all = 0, power_without = 0, power_scaled = 0;
  for (const SlowJoint& j : joints) {
    all += j.power;
    if (j.residual < kMinMisfit * j.power) continue;
    // what is a small part of the model has gravity in it, in another unit
    if (j.without_gravity < kMaxRatio * j.residual && j.by_factor > kMinMisfit * j.without_model) {
      without.push_back(j.number);
      power_without += j.power;
      without_varied = without_varied || j.without_gravity < j.by_load;
    } else if (j.by_factor < kMaxRatio * j.residual && (j.factor < 0.7 || j.factor > 1.4)) {
      scaled.push_back(j.number);
      factors.push_back(j.factor);
      power_scaled += j.power;
      scaled_varied = scaled_varied && j.by_factor < j.by_load;
    }
  }
  if (!without.empty() && power_without > all / 2)
    return {fmt::format("in slow poses tau of {} does not contain the torque of gravity. If the "
                        "recording has it removed, use [tau_without_gravity] in a map (--columns)",
                        listed(without)),
            without_varied};
  if (scaled.empty() || !(power_scaled > all / 2)) return {by_unit(joints), false};
  const auto [least, most] = std::minmax_element(factors.begin(), factors.end());
  // other masses than the file's, and loads, make factors, too, but each joint its own
  const double spread =
      *least * *most > 0 ? std::max(*least / *most, *most / *least) : kMaxSpreadOfGains;
  const bool far = *most < 0.5 || *least > 5;
  if (*least > 1 && !far && !(spread < 1.2 && factors.size() > 2)) return {};  // a load
  return {fmt::format("in slow poses tau of {} is {:.3g} times the torque of the model: {}",
                      listed(scaled), fmt::join(factors, ", "),
                      *most < 0 ? "its sign is reversed; set `sign = -1` in a map (--columns)"
                                : "are these currents, or is this another unit? In a map "
                                  "(--columns), [current] with `gain` (N m/A), or `unit`, `gain` "
                                  "and `sign` of [tau], say so"),
          scaled_varied && far && spread < kMaxSpreadOfGains &&
              (factors.size() > 1 || joints.size() == 1)};
}

// a factor near 1, which other masses might make in one joint, but not in all alike
std::string TorqueFit::by_unit(const std::vector<SlowJoint>& joints) {
  std::vector<double> factors;
  double all = 0, power = 0;
  for (const SlowJoint& j : joints) {
    all += j.power;
    if (!(j.by_factor < kMaxRatioOfUnit * j.residual)) continue;
    factors.push_back(j.factor);
    power += j.power;
  }
  if (factors.size() < 2 || !(power > all / 2)) return "";
  const auto [least, most] = std::minmax_element(factors.begin(), factors.end());
  if (*most > kSame * *least || std::max(*most, 1 / *least) < kMinUnit) return "";
  return fmt::format(
      "in slow poses all torques are {:.3g} times those of the model: is this another unit (lbf "
      "ft: 0.738)? `unit` or `gain` of [tau] in a map (--columns) says so",
      *least);
}

// what a recording has without gravity is still a small part of it
std::string TorqueFit::by_added_gravity() const {
  constexpr double kMostPart = 0.2;  // [1] more is a load, or masses
  std::vector<int> joints;
  std::vector<double> factors;
  double all = 0, power = 0;
  for (int j = 0; j < n_; ++j) {
    const Windows windows = slow(j);
    if (windows.size() < kMinWindows) continue;
    const auto measured = [j](const WindowMean& w) { return w.tau[j] - w.gravity[j]; };
    const double s = factor(windows, j, measured);
    const double carried = mean_square(windows, [j](const WindowMean& w) { return w.model[j]; });
    all += carried;
    const double by_factor =
        misfit(windows, j, [&](const WindowMean& w) { return measured(w) - s * w.model[j]; });
    if (std::abs(s) > kMostPart || by_factor > kMinMisfit * misfit(windows, j, measured)) continue;
    joints.push_back(j + 1);
    factors.push_back(s);
    power += carried;
  }
  if (joints.empty() || !(power > all / 2)) return "";
  return fmt::format(
      "what is read as torque without gravity is, in slow poses, {:.3g} times the model's torque "
      "with it in {}: is gravity in it, in another unit (currents, or the motor's side of a gear)? "
      "In a map (--columns), [current], or `unit` and `gain` of [tau], say so",
      fmt::join(factors, ", "), listed(joints));
}

// a channel that says the same all the time, though the arm moves
std::string TorqueFit::by_rest() const {
  std::vector<int> dead;
  const Windows windows = thinned();
  for (int j = 0; j < n_; ++j) {
    const auto range = [&](auto&& of) {
      double least = of(*windows[0]), most = least;
      for (const WindowMean* w : windows)
        least = std::min(least, of(*w)), most = std::max(most, of(*w));
      return most - least;
    };
    const double varies = range([j](const WindowMean& w) { return w.model[j]; });
    if (varies > kMinTorqueShare / 5 * arm_.usual_torque[j] &&
        range([j](const WindowMean& w) { return w.tau[j]; }) < 1e-9 * varies)
      dead.push_back(j + 1);
  }
  if (dead.empty()) return "";
  return fmt::format("tau of {} never changes, though the arm moves: is it measured?",
                     listed(dead));
}

// of joints that carry little, too
TorqueFit::Cause TorqueFit::by_sign() const {
  std::vector<int> reversed;
  bool varied = false;
  const Windows windows = thinned();
  for (int j = 0; j < n_; ++j) {
    const double power = mean_square(windows, [j](const WindowMean& w) { return w.model[j]; });
    const auto left = [j](const WindowMean& w) { return w.tau[j] - w.model[j]; };
    const double residual = misfit(windows, j, left);
    const double other =
        misfit(windows, j, [j](const WindowMean& w) { return -w.tau[j] - w.model[j]; });
    if (!(residual > kMinMisfit * power) || !(other < kMaxRatio * residual)) continue;
    reversed.push_back(j + 1);
    varied = varied || other < kMaxRatio * misfit(windows, j, left, true);
  }
  if (reversed.empty()) return {};
  return {fmt::format("the sign of tau of {} is reversed: set `sign` of [tau] in a map "
                      "(--columns); where q and qd are reversed, too, also that of [q] and [qd]",
                      listed(reversed)),
          varied};
}

// two joints in each other's columns, tau alone or all of them
std::string TorqueFit::by_order() const {
  const Windows windows = thinned();
  // of residual(window, number of the window, joint), over all joints, by their size; moves(joint)
  // is the one whose motion is that joint's
  const auto missed_by = [&](auto&& moves, auto&& residual, bool load = false) {
    double sum = 0;
    for (int j = 0; j < n_; ++j) {
      std::size_t k = 0;
      sum +=
          misfit(
              windows, moves(j), [&](const WindowMean& w) { return residual(w, k++, j); }, load) /
          std::pow(arm_.usual_torque[j], 2);
    }
    return sum;
  };
  const auto itself = [](int j) { return j; };
  const auto left = [](const WindowMean& w, std::size_t, int j) { return w.tau[j] - w.model[j]; };
  const double missed = missed_by(itself, left);
  const double with_loads = missed_by(itself, left, true);  // like the offset of a sensor
  double least = kMaxRatio * std::min(missed, with_loads);
  std::string best;
  std::vector<VectorN> gravity(windows.size());
  for (int a = 0; a < n_; ++a) {
    for (int b = a + 1; b < n_; ++b) {
      const auto other = [a, b](int j) { return j == a ? b : j == b ? a : j; };
      const auto consider = [&](double misses, const char* what) {
        if (!(misses < least)) return;
        least = misses;
        best = fmt::format(
            "{} of joints {} and {} fit the model if they are exchanged: name the columns in a map "
            "(--columns), or set its `order`",
            what, a + 1, b + 1);
      };
      consider(missed_by(itself, [&](const WindowMean& w, std::size_t,
                                     int j) { return w.tau[other(j)] - w.model[j]; }),
               "tau");
      // the model's motion is that of the wrong joints, so only gravity is compared
      for (std::size_t k = 0; k < windows.size(); ++k) {
        VectorN q = windows[k]->q;
        std::swap(q[a], q[b]);
        gravity[k] = model_.gravity(q);
      }
      consider(missed_by(other, [&](const WindowMean& w, std::size_t k,
                                    int j) { return w.tau[other(j)] - gravity[k][j]; }),
               "q, qd and tau");
    }
  }
  double power = 0;
  for (int j = 0; j < n_; ++j)
    power += mean_square(windows, [j](const WindowMean& w) { return w.model[j]; }) /
             std::pow(arm_.usual_torque[j], 2);
  return missed > kMinOrderMisfit * power ? best : "";
}

bool TorqueFit::is_long_enough() const {
  return windows_.size() >= kMinWindows;
}

std::string TorqueFit::contradiction() const {
  if (!is_long_enough()) return "";
  if (std::string why = by_rest(); !why.empty()) return why;
  if (std::string why = by_order(); !why.empty()) return why;
  if (Cause cause = by_gravity(); cause.varied) return cause.words;
  if (Cause cause = by_sign(); cause.varied) return cause.words;
  return "";
}

std::string TorqueFit::doubt() const {
  if (gravity_added_)
    if (std::string why = by_added_gravity(); !why.empty()) return why + ". Or it carries a load";
  for (const Cause& cause : {by_gravity(), by_sign()})
    if (!cause.varied && !cause.words.empty())
      return cause.words + ". Or else its masses are not those of the file, or it carries a load";
  double power = 0, residual = 0;
  for (int j = 0; j < n_; ++j) {
    const Windows windows = slow(j);
    if (windows.size() < kMinWindows) continue;
    power += mean_square(windows, [j](const WindowMean& w) { return w.model[j]; });
    residual += misfit(windows, j, [j](const WindowMean& w) { return w.tau[j] - w.model[j]; });
  }
  if (!(residual > power)) return "";
  return fmt::format(
      "in slow poses tau is {:.3g} N m away from the {:.3g} N m that hold the robot's masses: is "
      "this recording of this robot, are the joints in this order, and did it carry an unknown "
      "load?",
      std::sqrt(residual), std::sqrt(power));
}

bool fits(const TorqueFit& fit, const std::string& path) {
  if (const std::string why = fit.contradiction(); !why.empty())
    throw std::invalid_argument(fmt::format("{}: {}", path, why));
  if (!fit.is_long_enough())
    say(
        fmt::format("{}: too short to compare its torques with the robot's: {} windows of {:g} s "
                    "without a gap or a contact are needed",
                    path, kMinWindows, kWindow));
  const std::string why = fit.doubt();
  if (!why.empty()) say(fmt::format("{}: {}", path, why));
  return why.empty();
}

bool torques_fit(const ArmTree& arm, const Trace& log, bool gravity_added,
                 const std::string& path) {
  TorqueFit fit(arm, log.torque_at_instants, gravity_added);
  fit.take(log);
  return fits(fit, path);
}

}  // namespace tauext
