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
#include <optional>
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
  using Detectors = std::vector<std::unique_ptr<DetectorStage<Scalar>>>;

  explicit SeenRuns(int samples)
      : samples_(static_cast<std::size_t>(samples)), estimates_(samples_.size()) {}

  int size() const { return static_cast<int>(samples_.size()); }
  std::span<const Sample> samples() const { return samples_; }
  Sample& sample(int k) { return samples_[static_cast<std::size_t>(k)]; }
  Estimates& estimate(int k) { return estimates_[static_cast<std::size_t>(k)]; }

  // the samples of which no run's estimate is used; nothing where runs differ in that, or where an
  // estimate is no number or diverged, so that a detector starts anew
  using LeftOut = std::optional<std::vector<std::size_t>>;
  LeftOut left_out() const {
    std::vector<std::size_t> all;
    for (std::size_t k = 0; k < samples_.size(); ++k) {
      if (is_ok(k)) continue;
      int others = 0;
      for (int i = 0; i < kWidth; ++i) {
        if (!is_finite(k, i) || status(k, i) == Status::kDiverged) return std::nullopt;
        others += !used(status(k, i));
      }
      if (others == kWidth) all.push_back(k);
      if (others % kWidth != 0) return std::nullopt;
    }
    return all;
  }
  // detectors are silent there
  void leave_out(std::vector<std::size_t> samples) { left_out_ = std::move(samples); }

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
  void watch(DetectorStage<Scalar>& d, double from, const Look& look) const {
    DetectionOf<Scalar> said;
    auto silent = left_out_.begin();
    for (std::size_t k = 0; k < samples_.size(); ++k) {
      if (silent != left_out_.end() && *silent == k)
        ++silent;
      else
        d.run(input(k, 1), {&said, 1});
      if (of_run(samples_[k].t, 0) >= from) look(d);
    }
  }

 private:
  static constexpr int kWidth = width_of<Scalar>();
  static constexpr std::size_t kBlock = 128;  // samples that stay in the second cache

  // calls look(t, answer) for the samples of the block from k on
  template <class Look>
  void run(DetectorStage<Scalar>& d, std::size_t k, const Look& look) const {
    std::array<DetectionOf<Scalar>, kBlock> said;
    const std::size_t end = std::min(k + kBlock, samples_.size());
    auto silent = std::lower_bound(left_out_.begin(), left_out_.end(), k);
    for (std::size_t from = k, to; from < end; from = to + 1) {
      to = silent == left_out_.end() ? end : std::min(*silent++, end);
      d.run(input(from, to - from), {&said[from - k], to - from});
      if (to < end) said[to - k] = nothing();
    }
    for (std::size_t i = k; i < end; ++i) look(of_run(samples_[i].t, 0), said[i - k]);
  }

  DetectorInput<Scalar> input(std::size_t from, std::size_t n) const {
    return {std::span(samples_).subspan(from, n), std::span(estimates_).subspan(from, n)};
  }

  // what detect() says of an estimate that is none
  static DetectionOf<Scalar> nothing() {
    if constexpr (kWidth == 1) {
      return {};
    } else {
      return {no<Scalar>(), Scalar(0), contact_as<Scalar>(Detection().contact)};
    }
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
  std::vector<std::size_t> left_out_;
};

}  // namespace tauext::detail
