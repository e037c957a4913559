// SPDX-License-Identifier: Apache-2.0
/// @file
/// A trace as estimators and detectors read it, made once for all of them.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstddef>
#include <functional>
#include <memory>
#include <string_view>
#include <utility>
#include <vector>

#include "bench/roster/stages.h"
#include "bench/roster/thresholds.h"
#include "mjcf/trace/trace.h"

namespace tauext {

/// Many estimators over one trace, and many detectors behind each. Specifications and settings are
/// those of Robot, and so are its errors.
class Session {
 public:
  virtual ~Session() = default;

  /// Runs an estimator over the trace. Detectors see its estimates from now on.
  /// @throws std::invalid_argument for one that needs a truth which the trace does not have
  virtual Output estimate(std::string_view estimator) = 0;
  /// Detectors see these estimates of the trace from now on.
  virtual void use(const Output& estimates) = 0;

  /// What a detector says of the estimates, sample by sample; until the next call.
  virtual const std::vector<Detection>& detect(std::string_view detector,
                                               const DetectorSettings& settings) = 0;
  /// The largest statistic of a calibratable detector, joint by joint, over samples with t >= from
  /// [s].
  virtual Eigen::VectorXd largest_statistic(std::string_view detector,
                                            const DetectorSettings& settings, double from) = 0;
  /// The mean of z z^T over samples with t >= from, z the change() of a detector with a metric.
  virtual Eigen::MatrixXd covariance(std::string_view detector, const DetectorSettings& settings,
                                     double from) = 0;
};

/// Of an arm with N joints, of whose robot these make estimators and detectors.
template <int N>
class SessionOf final : public Session {
 public:
  /// Makes an estimator of a specification.
  using MakeEstimator = std::function<std::unique_ptr<EstimatorStage<N>>(std::string_view)>;
  /// Makes a detector of a specification.
  using MakeDetector =
      std::function<std::unique_ptr<DetectorStage<N>>(std::string_view, const DetectorSettings&)>;

  /// Over the trace.
  SessionOf(const Trace& trace, MakeEstimator estimator, MakeDetector detector)
      : estimator_(std::move(estimator)), detector_(std::move(detector)) {
    const auto n = static_cast<std::size_t>(trace.size());
    samples_.reserve(n);
    for (int k = 0; k < trace.size(); ++k) samples_.push_back(trace.measurement<N>(k));
    estimates_.resize(n);
    detections_.resize(n);
  }

  Output estimate(std::string_view estimator) override {
    const auto stage = estimator_(estimator);
    stage->run(samples_, estimates_);
    Output out{Eigen::MatrixXd(N, static_cast<Eigen::Index>(samples_.size())), {}, {}, {}};
    for (const Estimate<N>& e : estimates_) add(e, out);
    return out;
  }

  void use(const Output& estimates) override {
    for (std::size_t k = 0; k < samples_.size(); ++k)
      estimates_[k] = {estimates.tau_ext.col(static_cast<Eigen::Index>(k)), estimates.status[k]};
  }

  const std::vector<Detection>& detect(std::string_view detector,
                                       const DetectorSettings& settings) override {
    detector_(detector, settings)->run(samples_, estimates_, detections_);
    return detections_;
  }

  Eigen::VectorXd largest_statistic(std::string_view detector, const DetectorSettings& settings,
                                    double from) override {
    Vec<N> largest = Vec<N>::Zero();
    watch(detector, settings, from,
          [&](const DetectorStage<N>& d) { largest = largest.cwiseMax(d.statistic()); });
    return largest;
  }

  Eigen::MatrixXd covariance(std::string_view detector, const DetectorSettings& settings,
                             double from) override {
    Mat<N> sum = Mat<N>::Zero();
    int count = 0;
    watch(detector, settings, from, [&](const DetectorStage<N>& d) {
      sum += d.change() * d.change().transpose();
      ++count;
    });
    return sum / std::max(count, 1);
  }

 private:
  // look(detector) after every sample with t >= from
  template <class Look>
  void watch(std::string_view detector, const DetectorSettings& settings, double from,
             Look&& look) const {
    const auto d = detector_(detector, settings);
    Detection out;
    for (std::size_t k = 0; k < samples_.size(); ++k) {
      d->run({&samples_[k], 1}, {&estimates_[k], 1}, {&out, 1});
      if (samples_[k].t >= from) look(*d);
    }
  }

  MakeEstimator estimator_;
  MakeDetector detector_;
  std::vector<Measurement<N>> samples_;
  std::vector<Estimate<N>> estimates_;
  std::vector<Detection> detections_;
};

}  // namespace tauext
