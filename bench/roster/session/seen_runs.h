// SPDX-License-Identifier: Apache-2.0
/// @file
/// The samples of a run, or of several at once, what an estimator makes of them, and what detectors
/// make of that.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "bench/roster/session/listener.h"
#include "bench/roster/session/soundness.h"
#include "bench/roster/stages.h"
#include "estimators/math/pack.h"
#include "estimators/runs/runs.h"

namespace tauext::detail {

template <int N, int W>
struct EstimateOf<N, Pack<W>> {
  using type = RunsEstimate<N, W>;
};

// of N joints; with a Pack for Scalar, of as many runs, which are sampled at the same times
template <int N, class Scalar>
class SeenRuns {
 public:
  using Sample = Measurement<N, Scalar>;
  using Estimates = typename EstimateOf<N, Scalar>::type;
  using Detectors = std::vector<std::unique_ptr<DetectorStage<N, Scalar>>>;

  explicit SeenRuns(int samples)
      : samples_(static_cast<std::size_t>(samples)), estimates_(samples_.size()) {}

  int size() const { return static_cast<int>(samples_.size()); }
  std::span<const Sample> samples() const { return samples_; }
  Sample& sample(int k) { return samples_[static_cast<std::size_t>(k)]; }
  Estimates& estimate(int k) { return estimates_[static_cast<std::size_t>(k)]; }

  void run(EstimatorStage<N, Scalar>& estimator) { estimator.run(samples_, estimates_); }

  // of the estimates of each run
  std::array<Soundness, width_of<Scalar>()> soundness() const {
    std::array<Soundness, kWidth> all;
    for (std::size_t k = 0; k < samples_.size(); ++k) {
      if (is_ok(k)) continue;
      for (int i = 0; i < kWidth; ++i) {
        all[static_cast<std::size_t>(i)].take(of_run(samples_[k].t, i), status(k, i), joints(k, i),
                                              is_finite(k, i));
      }
    }
    return all;
  }

  std::vector<std::vector<Answers>> answers(const Detectors& detectors,
                                            std::span<const double> levels, double from) const {
    std::vector<Listener<Scalar>> listeners(detectors.size(), {levels, from});
    for (std::size_t k = 0; k < samples_.size(); k += kBlock) {
      for (std::size_t d = 0; d < detectors.size(); ++d) {
        run(*detectors[d], k,
            [&](double t, const DetectionOf<Scalar>& said) { listeners[d].take(t, said); });
      }
    }
    std::vector<std::vector<Answers>> all;
    for (Listener<Scalar>& l : listeners) all.push_back(std::move(l).answers());
    return all;
  }

  // calls look(detector) after every sample with t >= from
  template <class Look>
  void watch(DetectorStage<N, Scalar>& d, double from, const Look& look) const {
    DetectionOf<Scalar> said;
    for (std::size_t k = 0; k < samples_.size(); ++k) {
      d.run({&samples_[k], 1}, {&estimates_[k], 1}, {&said, 1});
      if (of_run(samples_[k].t, 0) >= from) look(d);
    }
  }

 private:
  static constexpr int kWidth = width_of<Scalar>();
  static constexpr std::size_t kBlock = 128;  // samples that stay in the second cache

  // calls look(t, answer) for the samples of the block from k on
  template <class Look>
  void run(DetectorStage<N, Scalar>& d, std::size_t k, const Look& look) const {
    std::array<DetectionOf<Scalar>, kBlock> said;
    const std::size_t n = std::min(kBlock, samples_.size() - k);
    d.run({&samples_[k], n}, {&estimates_[k], n}, {said.data(), n});
    for (std::size_t i = 0; i < n; ++i) look(of_run(samples_[k + i].t, 0), said[i]);
  }

  Status status(std::size_t k, int i) const { return of_run(estimates_[k].status, i); }
  std::uint8_t joints(std::size_t k, int i) const { return of_run(estimates_[k].joints, i); }
  bool is_ok(std::size_t k) const {
    bool ok = finite(estimates_[k].tau_ext);
    for (int i = 0; i < kWidth; ++i) ok = ok && status(k, i) == Status::kOk && joints(k, i) == 0;
    return ok;
  }
  bool is_finite(std::size_t k, int i) const {
    for (int j = 0; j < N; ++j) {
      if (!std::isfinite(of_run(estimates_[k].tau_ext[j], i))) return false;
    }
    return true;
  }

  std::vector<Sample> samples_;
  std::vector<Estimates> estimates_;
};

}  // namespace tauext::detail
