// SPDX-License-Identifier: Apache-2.0
/// @file
/// What an estimator does with a sample before any arithmetic: every estimator asks here first.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <stdexcept>

#include "estimators/parameters.h"
#include "estimators/types.h"

namespace tauext {

/// A norm [rad, rad/s, N m] beyond which a reading is a broken sensor and no robot's.
inline constexpr double kMeasurementLimit = 1e6;

/// A norm [N m] beyond which an estimate has diverged.
inline constexpr double kEstimateLimit = 1e9;

/// |x| <= limit; false if an element is NaN or infinite.
template <class Derived>
bool within(const Eigen::MatrixBase<Derived>& x, double limit) noexcept {
  return x.squaredNorm() <= limit * limit;
}

/// Parameters are checked when an estimator is built, which may throw; its steps never do.
/// @throws std::invalid_argument(what) unless ok
inline void require(bool ok, const char* what) {
  if (!ok) throw std::invalid_argument(what);
}

/// The longest step [s] of an estimator, as its Parameters list it.
template <class P>
constexpr auto max_gap_field() {
  return Field{"max_gap", &P::max_gap, "s", 1e-4, 1e3, "a longer gap restarts the estimator"};
}

/// The one bandwidth [rad/s] of an estimator, as its Parameters list it.
template <class P>
constexpr auto bandwidth_field() {
  return Field{"bandwidth",     &P::bandwidth,  "rad/s",
               kLeastBandwidth, kMostBandwidth, "larger is faster and noisier"};
}

/// Time and status of the samples an estimator has used.
class Sampling {
 public:
  /// @param max_gap [s] longest step to integrate over
  /// @throws std::invalid_argument if it is not positive
  explicit Sampling(double max_gap) : max_gap_(max_gap) {
    require(max_gap > 0, "max_gap [s] must be positive");
  }

  void reset() noexcept { started_ = false; }

  /// Whether y can be used: kOk to step by h(), kStarted to start at y, kBadMeasurement to ignore
  /// it.
  template <int N>
  [[gnu::always_inline]] Status accept(const Measurement<N>& y) noexcept {
    const bool in_order = !started_ || y.t > t_;
    if (!std::isfinite(y.t) || !in_order || !within(y.q, kMeasurementLimit) ||
        !within(y.qd, kMeasurementLimit) || !within(y.tau, kMeasurementLimit)) {
      return Status::kBadMeasurement;
    }
    h_ = y.t - t_;
    t_ = y.t;
    if (!started_ || h_ > max_gap_) {
      started_ = true;
      return Status::kStarted;
    }
    return Status::kOk;
  }

  double h() const noexcept { return h_; }  ///< [s] from the last used sample to this one

 private:
  double max_gap_;
  double t_ = 0;
  double h_ = 0;
  bool started_ = false;
};

/// Whether a step [s] needs anew what was made for the last one. Time stamps on a grid differ in
/// their last bits, so steps alike to 1e-9 count as one.
class StepChange {
 public:
  /// Whether h [s] differs from the last one, which it becomes.
  bool operator()(double h) noexcept {
    if (std::abs(h - h_) <= 1e-9 * h_) return false;
    h_ = h;
    return true;
  }

 private:
  double h_ = 0;
};

/// How a nonlinear model is stepped from k-1 to k.
enum class Integration : std::uint8_t {
  kSecondOrder,  ///< an error of h^2: the mean of both ends, or the Taylor terms of h^2
  kEuler,  ///< from the values at k-1 alone, as the paper prints: in motion an error of h/2 B qddd
};

constexpr auto choices(Integration) {
  return std::array{Choice<Integration>{"second_order", Integration::kSecondOrder},
                    Choice<Integration>{"euler", Integration::kEuler}};
}

/// What an observer assumes before its first sample.
enum class Start : std::uint8_t {
  kFirstMeasurement,  ///< the arm moves as first measured and nothing touches it
  kZero,              ///< the state is zero, as the paper prints (its arm starts at rest at q = 0)
};

constexpr auto choices(Start) {
  return std::array{Choice<Start>{"first_measurement", Start::kFirstMeasurement},
                    Choice<Start>{"zero", Start::kZero}};
}

/// How the model is stepped, as Parameters list it.
template <class P>
constexpr auto integration_field() {
  return Field{"integration", &P::integration, "", 0, 0, "euler, as printed, errs in motion"};
}

/// What is assumed at first, as Parameters list it.
template <class P>
constexpr auto start_field() {
  return Field{"start", &P::start, "", 0, 0, "zero, as printed, errs for an arm in motion"};
}

}  // namespace tauext
