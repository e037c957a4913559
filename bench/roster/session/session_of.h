// SPDX-License-Identifier: Apache-2.0
/// @file
/// The one implementation of Session.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "bench/roster/session/seen_runs.h"
#include "bench/roster/session/session.h"
#include "bench/roster/stages.h"
#include "estimators/sampling.h"
#include "estimators/tree/run_terms.h"
#include "mjcf/trace/trace.h"

namespace tauext::detail {

// how a session makes what it is asked for
template <int N, int W>
struct Makers {
  using Lanes = Pack<W>;
  template <class Stage>
  using Of = std::function<std::unique_ptr<Stage>(std::string_view, const MadeFor<N, W>&)>;
  template <class Stage>
  using With = std::function<std::unique_ptr<Stage>(const Asked&)>;

  Of<EstimatorStage<N>> estimator;
  With<DetectorStage<>> detector;
  // the same of several runs; null for one that cannot
  Of<EstimatorStage<N, Lanes>> estimator_of_runs;
  With<DetectorStage<Lanes>> detector_of_runs;
};

// of an arm with N joints; W runs at once (in its name: code with other flags has another W)
template <int N, int W = kRuns>
class SessionOf final : public Session {
  using Lanes = Pack<W>;
  using LeftOut = typename SeenRuns<N, double>::LeftOut;

 public:
  // the traces must outlive it; more than W go one by one
  SessionOf(std::span<const Trace> traces, Makers<N, W> make)
      : traces_(traces), make_(std::move(make)) {
    if (traces.size() < 2 || traces.size() > W || !are_alike()) return;
    lanes_.emplace(traces.front().size());
    in_lanes([&](int k, std::size_t run, int lane) {
      put(traces[run].template measurement<N>(k), lane, lanes_->sample(k));
    });
    terms_.emplace(lanes_->samples());
  }

  std::vector<std::string> estimate(std::string_view estimator) override {
    if (lanes_) {
      const auto stage =
          make_.estimator_of_runs(estimator, {traces_.front(), ++asked_ > 1 ? &*terms_ : nullptr});
      if (stage) return estimate_at_once(*stage);
    }
    std::vector<std::string> why;
    LeftOut left_out;
    for (std::size_t i = 0; i < traces_.size(); ++i) {
      SeenRuns<N, double>& run = alone()[i];
      run.run(*make_.estimator(estimator, {traces_[i]}));
      why.push_back(run.soundness().front().why(traces_[i].size()));
      if (i == 0) left_out = run.left_out();
      if (i > 0 && left_out != run.left_out()) left_out.reset();
    }
    one_by_one_ = true;
    at_once_ = lanes_ && left_out;
    if (at_once_) {
      go_together(*left_out);
      alone_.clear();
      one_by_one_ = false;
    }
    return why;
  }

  std::vector<std::vector<Answers>> answers(std::span<const Asked> detectors,
                                            std::span<const double> levels, double from) override {
    std::vector<std::vector<Answers>> all(detectors.size());
    typename SeenRuns<N, Lanes>::Detectors at_once;
    std::vector<std::size_t> which, others;
    for (std::size_t d = 0; d < detectors.size(); ++d) {
      auto stage = of_runs(detectors[d]);
      (stage ? which : others).push_back(d);
      if (stage) at_once.push_back(std::move(stage));
    }
    if (!at_once.empty()) {
      auto said = lanes_->answers(at_once, levels, from);
      for (std::size_t i = 0; i < which.size(); ++i) {
        said[i].resize(traces_.size());
        all[which[i]] = std::move(said[i]);
      }
    }
    if (others.empty()) return all;
    for (const SeenRuns<N, double>& run : apart()) {
      typename SeenRuns<N, double>::Detectors stages;
      for (const std::size_t d : others) stages.push_back(make_.detector(detectors[d]));
      auto said = run.answers(stages, levels, from);
      for (std::size_t i = 0; i < others.size(); ++i)
        all[others[i]].push_back(std::move(said[i].front()));
    }
    return all;
  }

  std::vector<Eigen::VectorXd> largest_statistic(const Asked& detector, double from) override {
    const auto largest = [&](const auto& seen, auto& stage) {
      auto most = stage.statistic();
      require(most.size() == N, "largest_statistic() is of a calibratable detector");
      most.setZero();
      seen.watch(stage, from, [&](const auto& d) { most = most.cwiseMax(d.statistic()).eval(); });
      return most;
    };
    return of_each<Eigen::VectorXd>(detector, largest);
  }

  std::vector<Eigen::MatrixXd> covariance(const Asked& detector, double from) override {
    const auto mean = [&](const auto& seen, auto& stage) {
      using Scalar = typename std::decay_t<decltype(stage.change())>::Scalar;
      Mat<N, Scalar> sum = Mat<N, Scalar>::Zero();
      int count = 0;
      seen.watch(stage, from, [&](const auto& d) {
        require(d.change().size() == N, "covariance() is of a detector with a metric");
        const Vec<N, Scalar> z = d.change();
        sum += z * z.transpose();
        ++count;
      });
      return Mat<N, Scalar>(sum / Scalar(std::max(count, 1)));
    };
    return of_each<Eigen::MatrixXd>(detector, mean);
  }

 private:
  // calls f(sample, run, lane); lanes without a run repeat the first one
  template <class F>
  void in_lanes(const F& f) const {
    for (int k = 0; k < lanes_->size(); ++k) {
      for (int lane = 0; lane < W; ++lane) {
        const auto run = static_cast<std::size_t>(lane);
        f(k, run < traces_.size() ? run : 0, lane);
      }
    }
  }

  // of one clock, and of samples that a detector would use
  bool are_alike() const {
    return std::all_of(traces_.begin(), traces_.end(), [&](const Trace& t) {
      return t.t == traces_.front().t &&
             t.torque_at_instants == traces_.front().torque_at_instants &&
             within(t.qd.reshaped(), kMeasurementLimit) &&
             within(t.tau.reshaped(), kMeasurementLimit);
    });
  }

  std::vector<std::string> estimate_at_once(EstimatorStage<N, Lanes>& stage) {
    lanes_->run(stage);
    std::vector<std::string> why;
    const auto soundness = lanes_->soundness();
    for (std::size_t i = 0; i < traces_.size(); ++i)
      why.push_back(soundness[i].why(lanes_->size()));
    LeftOut left_out = lanes_->left_out();
    at_once_ = left_out.has_value();
    if (at_once_) lanes_->leave_out(*std::move(left_out));
    one_by_one_ = false;
    return why;
  }

  // null unless it can go on at once
  std::unique_ptr<DetectorStage<Lanes>> of_runs(const Asked& detector) const {
    return at_once_ ? make_.detector_of_runs(detector) : nullptr;
  }

  // each run for itself
  std::vector<SeenRuns<N, double>>& alone() {
    if (!alone_.empty()) return alone_;
    for (const Trace& t : traces_) {
      alone_.emplace_back(t.size());
      for (int k = 0; k < t.size(); ++k) alone_.back().sample(k) = t.measurement<N>(k);
    }
    return alone_;
  }

  // the same, with estimates that were made at once
  const std::vector<SeenRuns<N, double>>& apart() {
    if (one_by_one_) return alone();
    for (std::size_t i = 0; i < traces_.size(); ++i) {
      for (int k = 0; k < lanes_->size(); ++k) {
        const auto& all = lanes_->estimate(k);
        Estimate<N>& e = alone()[i].estimate(k);
        for (int j = 0; j < N; ++j) e.tau_ext[j] = all.tau_ext[j][static_cast<int>(i)];
        e.status = all.status[i];
        e.joints = all.joints[i];
      }
    }
    one_by_one_ = true;
    return alone_;
  }

  // estimates that were made one by one, all at once
  void go_together(const std::vector<std::size_t>& left_out) {
    in_lanes([&](int k, std::size_t run, int lane) {
      const Estimate<N>& e = alone_[run].estimate(k);
      auto& all = lanes_->estimate(k);
      for (int j = 0; j < N; ++j) all.tau_ext[j].set(lane, e.tau_ext[j]);
      all.status[static_cast<std::size_t>(lane)] = e.status;
      all.joints[static_cast<std::size_t>(lane)] = e.joints;
    });
    lanes_->leave_out(left_out);
  }

  // what f(samples, stage) says of each run
  template <class Value, class F>
  std::vector<Value> of_each(const Asked& detector, const F& f) {
    std::vector<Value> values;
    if (const auto stage = of_runs(detector)) {
      const auto all = f(*lanes_, *stage);
      for (std::size_t i = 0; i < traces_.size(); ++i)
        values.push_back(all.unaryExpr([&](const Lanes& x) { return x[static_cast<int>(i)]; }));
      return values;
    }
    for (const SeenRuns<N, double>& run : apart()) {
      const auto stage = make_.detector(detector);
      values.push_back(f(run, *stage));
    }
    return values;
  }

  std::span<const Trace> traces_;
  Makers<N, W> make_;
  std::vector<SeenRuns<N, double>> alone_;    // each run, once it is asked for
  std::optional<SeenRuns<N, Lanes>> lanes_;   // all of them, if they are alike
  std::optional<RunTerms<N, Lanes>> terms_;   // there; from the second estimator on
  int asked_ = 0;                             // for so many estimators
  bool at_once_ = false, one_by_one_ = true;  // whether detectors find estimates there
};

}  // namespace tauext::detail
