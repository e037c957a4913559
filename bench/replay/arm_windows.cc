// SPDX-License-Identifier: Apache-2.0
#include "bench/replay/arm_windows.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace tauext {
namespace {

constexpr double kWindow = 0.1, kStep = 0.01, kGap = 0.25;  // [s]
constexpr std::size_t kMaxWindows = 2048;
constexpr std::size_t kTogether = 8;  // windows that follow one another
constexpr double kFullSlip = 0.01;    // [rad/s] at which dry friction acts

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using VectorN = ArmWindow::VectorN;

// x of the least squares of y - C x, where the last two of x are friction, which is not below 0
VectorXd explained(const MatrixXd& C, const VectorXd& y) {
  const MatrixXd G = C.transpose() * C;
  const VectorXd b = C.transpose() * y;
  const Index n = C.cols(), free = n - 2;
  VectorXd best = VectorXd::Zero(n);
  double most = 0;  // of the squares that it takes away
  for (const auto& friction : {std::vector<Index>{free, free + 1}, {free}, {free + 1}, {}}) {
    std::vector<Index> columns(static_cast<std::size_t>(free));
    std::iota(columns.begin(), columns.end(), 0);
    columns.insert(columns.end(), friction.begin(), friction.end());
    if (columns.empty()) continue;
    const MatrixXd part = G(columns, columns);
    const VectorXd x = part.completeOrthogonalDecomposition().solve(b(columns));
    const double squares = x.dot(b(columns));
    if ((x.tail(static_cast<Index>(friction.size())).array() < 0).any() || !(squares > most))
      continue;
    most = squares;
    best.setZero();
    best(columns) = x;
    if (friction.size() == 2) break;  // no other is better
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

}  // namespace

WindowMaker::WindowMaker(const ArmTree& arm, bool torque_at_instants)
    : model_(detail::filled<TiedTree>(arm)), at_instants_(torque_at_instants), n_(arm.dof()) {}

ArmWindow WindowMaker::window(MatrixXd motion, const VectorN& tau) const {
  ArmWindow w;
  w.tau = tau;
  enum Rate { kRest, kGravityTorque, kSpeed, kDirection };
  using Rates = Eigen::Matrix<double, kMostCoordinates, 4>;
  Rates before = Rates::Zero(), sum = Rates::Zero();
  VectorN first = VectorN::Zero(), last = first;
  const Index samples = motion.cols();
  for (Index k = 0; k < samples; ++k) {
    VectorN q = VectorN::Zero(), qd = q;
    q.head(n_) = motion.col(k).segment(1, n_), qd.head(n_) = motion.col(k).tail(n_);
    const auto d = model_.momentum_dynamics(q, qd);
    last = d.B * qd;
    if (k == 0) first = last;
    Rates now;
    now.col(kRest) = model_.friction(qd) - d.bias;
    now.col(kGravityTorque) = model_.gravity(q);
    now.col(kSpeed) = qd;
    now.col(kDirection) = (qd / kFullSlip).array().tanh();
    if (k > 0) sum += (motion(0, k) - motion(0, k - 1)) / 2 * (before + now);
    before = now;
  }
  const double T = motion(0, samples - 1) - motion(0, 0);
  w.model = (last - first + sum.col(kRest)) / T;
  w.gravity = sum.col(kGravityTorque) / T;
  w.speed = sum.col(kSpeed) / T;
  w.direction = sum.col(kDirection) / T;
  w.motion = std::move(motion);
  return w;
}

void WindowMaker::interrupt(bool torque_at_instants) {
  begun_ = false;
  at_instants_ = torque_at_instants;
}

void WindowMaker::begin(const Sample& y) {
  begun_ = true;
  integral_ = VectorXd::Zero(n_);
  motion_.clear(), integrals_.clear();
  keep(y);
}

void WindowMaker::keep(const Sample& y) {
  VectorXd at(1 + 2 * n_);
  at << y.t, y.q, y.qd;
  motion_.push_back(std::move(at));
  integrals_.push_back(integral_);
}

void WindowMaker::take(const Sample& y, const VectorXd& tau, bool contact) {
  const double h = y.t - t_;
  const bool usable = y.q.allFinite() && y.qd.allFinite() && tau.allFinite() && !contact;
  const bool goes_on = usable && begun_ && h > 0 && h <= kGap;
  if (goes_on) integral_ += h * (at_instants_ ? VectorXd((torque_ + tau) / 2) : torque_);
  t_ = y.t, torque_ = tau;
  if (!goes_on) {
    begun_ = false;
    if (usable) begin(y);
    return;
  }
  if (y.t - motion_.back()[0] < kStep * (1 - 1e-6)) return;
  keep(y);
  if (y.t - motion_.front()[0] < kWindow * (1 - 1e-6)) return;
  close();
  begin(y);
}

void WindowMaker::close() {
  if (count_++ / kTogether % every_ != 0) return;
  MatrixXd motion(1 + 2 * n_, static_cast<Index>(motion_.size()));
  for (Index k = 0; k < motion.cols(); ++k) motion.col(k) = motion_[static_cast<std::size_t>(k)];
  const double T = motion_.back()[0] - motion_.front()[0];
  VectorN tau = VectorN::Zero();
  tau.head(n_) = integral_ / T;
  windows_.push_back(window(std::move(motion), tau));
  MatrixXd& steps = windows_.back().steps;
  steps.resize(n_, static_cast<Index>(motion_.size()) - 1);
  for (std::size_t k = 1; k < motion_.size(); ++k)
    steps.col(static_cast<Index>(k) - 1) = integrals_[k] - integrals_[k - 1];
  if (windows_.size() < kMaxWindows) return;
  for (std::size_t i = 0; i < kMaxWindows / 2; ++i)
    windows_[i] = std::move(windows_[i / kTogether * 2 * kTogether + i % kTogether]);
  windows_.resize(kMaxWindows / 2);
  every_ *= 2;
}

std::vector<const ArmWindow*> thinned(const ArmWindows& windows, std::size_t most) {
  std::vector<const ArmWindow*> some;
  for (std::size_t i = 0; i < windows.size(); i += 1 + windows.size() / most)
    some.push_back(&windows[i]);
  return some;
}

double misfit(const std::vector<const ArmWindow*>& windows, int j, const VectorXd& y,
              const MatrixXd& others) {
  if (windows.empty()) return 0;
  MatrixXd C(y.size(), others.cols() + 2);
  C.leftCols(others.cols()) = others;
  for (Index i = 0; i < y.size(); ++i) {
    const ArmWindow& w = *windows[static_cast<std::size_t>(i)];
    C.row(i).tail(2) << w.direction[j], w.speed[j];
  }
  const auto kept = best_fifths(y - C * explained(C, y));
  const VectorXd rest = y - C * explained(C(kept, Eigen::indexing::all), y(kept));
  return rest(best_fifths(rest)).squaredNorm() / static_cast<double>(kept.size());
}

double factor(const std::vector<const ArmWindow*>& windows, int j, const VectorXd& y) {
  MatrixXd C(y.size(), 3);
  for (Index i = 0; i < y.size(); ++i) {
    const ArmWindow& w = *windows[static_cast<std::size_t>(i)];
    C.row(i) << w.model[j], w.direction[j], w.speed[j];
  }
  const VectorXd first = C.colPivHouseholderQr().solve(y);
  const auto kept = best_fifths(y - C * first);
  return MatrixXd(C(kept, Eigen::indexing::all)).colPivHouseholderQr().solve(y(kept))[0];
}

}  // namespace tauext
