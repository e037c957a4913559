// SPDX-License-Identifier: Apache-2.0
/// @file
/// Estimators behind one virtual call for a batch of samples, and detectors behind them.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "bench/roster/detectors.h"
#include "estimators/concepts.h"
#include "estimators/math/pack.h"
#include "estimators/samples/status_counts.h"
#include "estimators/tree/run_terms.h"
#include "mjcf/trace/trace.h"

namespace tauext {

namespace detail {

// with a Pack: session/seen_runs.h
template <int N, class Scalar>
struct EstimateOf;
template <int N>
struct EstimateOf<N, double> {
  using type = Estimate<N>;
};

// what an estimator is made for; W runs at once (in its name: session/session_of.h)
template <int N, int W = kRuns>
struct MadeFor {
  const Trace& trace;                     // of several runs the first
  RunTerms<N, Pack<W>>* terms = nullptr;  // of all runs' samples, if other estimators see them, too
};

}  // namespace detail

/// An estimator of N joints, type-erased; with a Pack for Scalar, of several runs.
template <int N, class Scalar = double>
class EstimatorStage {
 public:
  using Estimates = typename detail::EstimateOf<N, Scalar>::type;  ///< of a sample

  virtual ~EstimatorStage() = default;
  virtual void reset() = 0;  ///< forgets all samples
  virtual void run(std::span<const Measurement<N, Scalar>> in,
                   std::span<Estimates> out) = 0;  ///< an estimate for each sample
};

/// The stage of this estimator; of Runs of one, with their Scalar.
template <class E, class Scalar = double>
class EstimatorStageOf final : public EstimatorStage<E::kDof, Scalar> {
 public:
  using typename EstimatorStage<E::kDof, Scalar>::Estimates;

  explicit EstimatorStageOf(E e) : e_(std::move(e)) {}  ///< takes it over
  void reset() override { e_.reset(); }
  /// As EstimatorStage says.
  void run(std::span<const Measurement<E::kDof, Scalar>> in, std::span<Estimates> out) override {
    for (std::size_t k = 0; k < in.size(); ++k) out[k] = e_.update(in[k]);
  }

 private:
  E e_;
};

/// What a run over a whole trace gives; one column or element per sample.
struct Output {
  Eigen::MatrixXd tau_ext;          ///< [N m]
  std::vector<Status> status;       ///< of the estimates
  std::vector<std::uint8_t> marks;  ///< empty without a detector
  StatusCounts counts;              ///< of the statuses
};

/// Adds what an estimator said of the next sample.
template <int N>
void add(const Estimate<N>& e, Output& to) {
  to.tau_ext.col(static_cast<Eigen::Index>(to.status.size())) = e.tau_ext;
  to.status.push_back(e.status);
  to.counts.add(e.status, e.joints);
}

/// An estimator, and a detector behind it if there is one, bound to the samples of a trace.
class Runner {
 public:
  virtual ~Runner() = default;
  /// From a reset over all samples.
  virtual Output run() = 0;
  /// The next batch of samples, from the begin again after the last one: the work that is timed.
  virtual void batch() = 0;
  static constexpr int kBatch = 1000;  ///< samples
};

/// What became of one sample of a live run.
struct Stepped {
  Status status = Status::kOk;  ///< of the estimate
  std::uint8_t joints = 0;      ///< that it is about, bit 0 for the first
  Detection detection;          ///< of the detector, if there is one
};

/// An estimator, and a detector behind it if there is one, one sample after the other.
class Stepper {
 public:
  virtual ~Stepper() = default;
  virtual void reset() noexcept = 0;  ///< forgets all samples
  /// Reads a value for each joint of q [rad], qd [rad/s] and tau [N m] at time t [s], and writes
  /// tau_ext [N m]. Allocates nothing.
  virtual Stepped step(double t, const double* q, const double* qd, const double* tau,
                       double* tau_ext) noexcept = 0;
};

/// Of these stages.
template <int N>
class StepperOf final : public Stepper {
 public:
  /// The second may be null.
  StepperOf(std::unique_ptr<EstimatorStage<N>> e, std::unique_ptr<DetectorStage<>> d)
      : estimator_(std::move(e)), detector_(std::move(d)) {}

  void reset() noexcept override {
    estimator_->reset();
    if (detector_) detector_->reset();
  }

  Stepped step(double t, const double* q, const double* qd, const double* tau,
               double* tau_ext) noexcept override {
    using Values = Eigen::Map<const Vec<N>>;
    const Measurement<N> y{t, Values(q), Values(qd), Values(tau)};
    Estimate<N> estimate;
    Stepped out;
    const std::span<const Measurement<N>> at(&y, 1);
    estimator_->run(at, {&estimate, 1});
    if (detector_)
      detector_->run({at, std::span<const Estimate<N>>(&estimate, 1)}, {&out.detection, 1});
    Vec<N>::Map(tau_ext) = estimate.tau_ext;
    out.status = estimate.status;
    out.joints = estimate.joints;
    return out;
  }

 private:
  std::unique_ptr<EstimatorStage<N>> estimator_;
  std::unique_ptr<DetectorStage<>> detector_;
};

/// Of these stages.
template <int N>
class RunnerOf final : public Runner {
 public:
  /// The second may be null.
  RunnerOf(std::unique_ptr<EstimatorStage<N>> e, std::unique_ptr<DetectorStage<>> d,
           const Trace& trace)
      : estimator_(std::move(e)), detector_(std::move(d)) {
    samples_.reserve(trace.size());
    for (int k = 0; k < trace.size(); ++k) samples_.push_back(trace.measurement<N>(k));
  }

  Output run() override {
    Output out{Eigen::MatrixXd(N, samples_.size()), {}, {}, {}};
    next_ = 0;
    for (std::size_t done = 0; done < samples_.size();) {
      const std::size_t n = advance();
      for (std::size_t k = 0; k < n; ++k) {
        add(estimates_[k], out);
        if (detector_) out.marks.push_back(detections_[k].mark);
      }
      done += n;
    }
    return out;
  }

  void batch() override {
    for (std::size_t n = 0; n < kBatch;) n += advance();
  }

 private:
  // up to a batch, not beyond the last sample
  std::size_t advance() {
    if (next_ == 0) {
      estimator_->reset();
      if (detector_) detector_->reset();
    }
    const std::size_t n = std::min<std::size_t>(kBatch, samples_.size() - next_);
    const std::span<const Measurement<N>> in(&samples_[next_], n);
    estimator_->run(in, {estimates_.data(), n});
    if (detector_)
      detector_->run({in, std::span<const Estimate<N>>(estimates_.data(), n)},
                     {detections_.data(), n});
    next_ = next_ + n == samples_.size() ? 0 : next_ + n;
    return n;
  }

  std::unique_ptr<EstimatorStage<N>> estimator_;
  std::unique_ptr<DetectorStage<>> detector_;
  std::vector<Measurement<N>> samples_;
  std::vector<Estimate<N>> estimates_ = std::vector<Estimate<N>>(kBatch);
  std::vector<Detection> detections_ = std::vector<Detection>(kBatch);
  std::size_t next_ = 0;
};

}  // namespace tauext
