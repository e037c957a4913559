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

// x of the least squares of y - C x, where the last of x, so many, are not below 0
VectorXd explained(const MatrixXd& C, const VectorXd& y, Index positive) {
  const MatrixXd G = C.transpose() * C;
  const VectorXd b = C.transpose() * y;
  const Index n = C.cols(), free = n - positive;
  VectorXd best = VectorXd::Zero(n);
  double most = 0;  // of the squares that it takes away
  for (unsigned some = (1U << positive); some-- > 0;) {
    std::vector<Index> columns(static_cast<std::size_t>(free));
    std::iota(columns.begin(), columns.end(), 0);
    for (Index i = 0; i < positive; ++i)
      if ((some >> i & 1U) != 0) columns.push_back(free + i);
    if (columns.empty()) continue;
    const MatrixXd part = G(columns, columns);
    const VectorXd x = part.completeOrthogonalDecomposition().solve(b(columns));
    const double squares = x.dot(b(columns));
    const Index bounded = static_cast<Index>(columns.size()) - free;
    if ((x.tail(bounded).array() < 0).any() || !(squares > most)) continue;
    most = squares;
    best.setZero();
    best(columns) = x;
    if (bounded == positive) break;  // no other is better
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

bool moves(const std::vector<const ArmWindow*>& windows) {
  constexpr double kMoves = 0.02;  // [rad/s]
  return std::any_of(windows.begin(), windows.end(),
                     [](const ArmWindow* w) { return w->speed.cwiseAbs().maxCoeff() > kMoves; });
}

WindowFit fit(const std::vector<const ArmWindow*>& windows, int joint, const VectorXd& y,
              const MatrixXd& any, const MatrixXd& positive) {
  const Index bounded = positive.cols() + 2, n = any.cols() + bounded;
  if (windows.empty()) return {VectorXd::Zero(n - 2), {}, 0};
  MatrixXd C(y.size(), n);
  if (any.cols() > 0) C.leftCols(any.cols()) = any;
  if (positive.cols() > 0) C.middleCols(any.cols(), positive.cols()) = positive;
  for (Index i = 0; i < y.size(); ++i) {
    const ArmWindow& w = *windows[static_cast<std::size_t>(i)];
    C.row(i).tail(2) << w.direction[joint], w.speed[joint];
  }
  const auto kept = best_fifths(y - C * explained(C, y, bounded));
  const VectorXd x = explained(C(kept, Eigen::indexing::all), y(kept), bounded);
  WindowFit found{x.head(n - 2), y - C * x};
  const auto best = best_fifths(found.residual);
  found.mean_square = found.residual(best).squaredNorm() / static_cast<double>(best.size());
  return found;
}

double misfit(const std::vector<const ArmWindow*>& windows, int j, const VectorXd& y,
              const MatrixXd& others) {
  return fit(windows, j, y, others).mean_square;
}

void undo_noise(WindowFit& fit, double s) {
  const double smaller = std::min(1., std::abs(s));
  fit.mean_square /= smaller * smaller + 1e-9;
}

double independent(const VectorXd& residual) {
  const Index n = residual.size() - 1;
  if (n < 1) return 0;
  const double most = 3 * std::sqrt(residual.squaredNorm() / static_cast<double>(n + 1));
  const VectorXd y = residual.array().min(most).max(-most);  // outliers
  const double alike = y.head(n).dot(y.tail(n)) / std::max(y.squaredNorm(), 1e-300);
  const double r = std::clamp(alike, 0., 0.98);
  return static_cast<double>(n) * (1 - r) / (1 + r);
}

VectorXd rotor_torque(const std::vector<const ArmWindow*>& windows, int joint) {
  return each(windows, [joint](const ArmWindow& w) {
    const Index last = w.motion.cols() - 1, qd = 1 + (w.motion.rows() - 1) / 2 + joint;
    return (w.motion(qd, last) - w.motion(qd, 0)) / (w.motion(0, last) - w.motion(0, 0));
  });
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
