// SPDX-License-Identifier: Apache-2.0
#include "bench/roster/session/session.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <memory>
#include <optional>
#include <type_traits>
#include <utility>

#include "bench/roster/robot.h"
#include "bench/roster/session/listener.h"
#include "bench/roster/session/soundness.h"
#include "estimators/math/truths.h"
#include "estimators/sampling.h"

namespace tauext {
namespace {

using detail::Listener;
using detail::of_run;
using Lanes = EstimatorType::Lanes;

// The samples of a run, or with a Pack of as many, which are sampled at the same times; and what an
// estimator makes of them.
template <class Scalar>
class RunBatch {
 public:
  using Detectors = std::vector<std::unique_ptr<DetectorStage<Scalar>>>;

  // the samples must outlive it
  explicit RunBatch(const SampleColumns<Scalar>& samples)
      : samples_(samples),
        tau_ext_(samples.size * static_cast<std::size_t>(samples.joints)),
        status_(samples.size),
        joints_(samples.size) {}

  std::size_t size() const { return samples_.size; }
  const SampleColumns<Scalar>& samples() const { return samples_; }
  Scalar* tau_ext(std::size_t k) {
    return &tau_ext_[k * static_cast<std::size_t>(samples_.joints)];
  }
  OfRuns<Scalar, Status>& status(std::size_t k) { return status_[k]; }
  OfRuns<Scalar, std::uint8_t>& of_joints(std::size_t k) { return joints_[k]; }

  // the samples of which no run's estimate is used; nothing where runs differ in that, or where an
  // estimate is no number or diverged, so that a detector starts anew
  using LeftOut = std::optional<std::vector<std::size_t>>;
  LeftOut left_out() const {
    std::vector<std::size_t> all;
    for (std::size_t k = 0; k < size(); ++k) {
      if (is_ok(k)) continue;
      int others = 0;
      for (int i = 0; i < kWidth; ++i) {
        const Status status = of_run(status_[k], i);
        if (!is_finite(k, i) || status == Status::kDiverged) return std::nullopt;
        others += !used(status);
      }
      if (others == kWidth) all.push_back(k);
      if (others % kWidth != 0) return std::nullopt;
    }
    return all;
  }
  // detectors are silent there
  void leave_out(std::vector<std::size_t> samples) { left_out_ = std::move(samples); }

  void run(EstimatorStage<Scalar>& estimator) {
    estimator.run(samples_, {tau_ext_.data(), status_.data(), joints_.data()});
  }

  // of the estimates of each run
  std::array<Soundness, detail::width_of<Scalar>()> soundness() const {
    std::array<Soundness, kWidth> all;
    for (std::size_t k = 0; k < size(); ++k) {
      if (is_ok(k)) continue;
      for (int i = 0; i < kWidth; ++i)
        all[static_cast<std::size_t>(i)].take(samples_.t[k], of_run(status_[k], i),
                                              of_run(joints_[k], i), is_finite(k, i));
    }
    return all;
  }

  std::vector<std::vector<Answers>> answers(const Detectors& detectors,
                                            std::span<const double> levels, double from) const {
    std::vector<Listener<Scalar>> listeners(detectors.size(), {levels, from});
    for (std::size_t k = 0; k < size(); k += kBlock) {
      for (std::size_t d = 0; d < detectors.size(); ++d)
        run(*detectors[d], k, [&](double t, const DetectionOf<Scalar>& detection) {
          listeners[d].take(t, detection);
        });
    }
    std::vector<std::vector<Answers>> all;
    for (Listener<Scalar>& l : listeners) all.push_back(std::move(l).answers());
    return all;
  }

  // calls look() after the detector has seen a sample with t >= from
  template <class Look>
  void watch(DetectorStage<Scalar>& d, double from, const Look& look) const {
    DetectionOf<Scalar> detection;
    auto silent = left_out_.begin();
    for (std::size_t k = 0; k < size(); ++k) {
      if (silent != left_out_.end() && *silent == k)
        ++silent;
      else
        d.run(input(k, 1), {&detection, 1});
      if (samples_.t[k] >= from) look();
    }
  }

 private:
  static constexpr int kWidth = detail::width_of<Scalar>();
  static constexpr std::size_t kBlock = 128;  // samples that stay in the second cache

  // calls look(t, detection) for the samples of the block from k on
  template <class Look>
  void run(DetectorStage<Scalar>& d, std::size_t k, const Look& look) const {
    std::array<DetectionOf<Scalar>, kBlock> detections;
    const std::size_t end = std::min(k + kBlock, size());
    auto silent = std::lower_bound(left_out_.begin(), left_out_.end(), k);
    for (std::size_t from = k, to; from < end; from = to + 1) {
      to = silent == left_out_.end() ? end : std::min(*silent++, end);
      d.run(input(from, to - from), {&detections[from - k], to - from});
      if (to < end) detections[to - k] = nothing();
    }
    for (std::size_t i = k; i < end; ++i) look(samples_.t[i], detections[i - k]);
  }

  DetectorInput<Scalar> input(std::size_t from, std::size_t n) const {
    const std::size_t at = from * static_cast<std::size_t>(samples_.joints);
    DetectorInput<Scalar> in{samples_.part(from, n), tau_ext_.data() + at};
    if constexpr (kWidth == 1) in.status = status_.data() + from;
    return in;
  }

  // what detect() says of an estimate that is none
  static DetectionOf<Scalar> nothing() {
    if constexpr (kWidth == 1)
      return {};
    else
      return {no<Scalar>(), Scalar(0), contact_as<Scalar>(Detection().contact)};
  }

  bool is_ok(std::size_t k) const {
    const auto at = k * static_cast<std::size_t>(samples_.joints);
    bool ok = finite(JointVecView<Scalar>(&tau_ext_[at], samples_.joints));
    for (int i = 0; i < kWidth; ++i)
      ok = ok && of_run(status_[k], i) == Status::kOk && of_run(joints_[k], i) == 0;
    return ok;
  }
  bool is_finite(std::size_t k, int i) const {
    const auto joints = static_cast<std::size_t>(samples_.joints);
    for (std::size_t j = 0; j < joints; ++j)
      if (!std::isfinite(of_run(tau_ext_[k * joints + j], i))) return false;
    return true;
  }

  SampleColumns<Scalar> samples_;
  std::vector<Scalar> tau_ext_;
  std::vector<OfRuns<Scalar, Status>> status_;
  std::vector<OfRuns<Scalar, std::uint8_t>> joints_;
  std::vector<std::size_t> left_out_;
};

// several runs of one clock, in the lanes of a register; lanes without a run repeat the first one
class LaneSamples {
 public:
  explicit LaneSamples(std::span<const Trace> traces) : traces_(traces) {
    const auto values = static_cast<std::size_t>(traces.front().q.size());
    q_.resize(values), qd_.resize(values), tau_.resize(values);
    for (std::size_t at = 0; at < values; ++at) {
      for (int lane = 0; lane < kRuns; ++lane) {
        const Trace& run = traces[run_of(lane)];
        q_[at].set(lane, run.q.data()[at]);
        qd_[at].set(lane, run.qd.data()[at]);
        tau_[at].set(lane, run.tau.data()[at]);
      }
    }
  }

  std::size_t run_of(int lane) const {
    const auto run = static_cast<std::size_t>(lane);
    return run < traces_.size() ? run : 0;
  }
  SampleColumns<Lanes> columns() const {
    const Trace& first = traces_.front();
    return {first.dof(),    static_cast<std::size_t>(first.size()),
            first.t.data(), q_.data(),
            qd_.data(),     tau_.data()};
  }

 private:
  std::span<const Trace> traces_;
  std::vector<Lanes> q_, qd_, tau_;
};

class SessionOf final : public Session {
  using LeftOut = RunBatch<double>::LeftOut;

 public:
  SessionOf(const Robot& robot, std::span<const Trace> traces) : robot_(robot), traces_(traces) {
    if (traces.size() < 2 || traces.size() > kRuns || !are_alike()) return;
    in_lanes_.emplace(traces);
    lanes_.emplace(in_lanes_->columns());
    terms_.emplace(in_lanes_->columns());
  }

  std::vector<std::string> estimate(std::string_view estimator) override {
    if (lanes_) {
      const auto stage =
          robot_.estimator_of_runs(estimator, traces_.front(), ++asked_ > 1 ? &*terms_ : nullptr);
      if (stage) return estimate_at_once(*stage);
    }
    std::vector<std::string> why;
    LeftOut left_out;
    for (std::size_t i = 0; i < traces_.size(); ++i) {
      RunBatch<double>& run = alone()[i];
      run.run(*robot_.estimator(estimator, traces_[i]));
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
    RunBatch<Lanes>::Detectors at_once;
    std::vector<std::size_t> which, others;
    for (std::size_t d = 0; d < detectors.size(); ++d) {
      auto stage = of_runs(detectors[d]);
      (stage ? which : others).push_back(d);
      if (stage) at_once.push_back(std::move(stage));
    }
    if (!at_once.empty()) {
      auto of_lanes = lanes_->answers(at_once, levels, from);
      for (std::size_t i = 0; i < which.size(); ++i) {
        of_lanes[i].resize(traces_.size());
        all[which[i]] = std::move(of_lanes[i]);
      }
    }
    if (others.empty()) return all;
    for (const RunBatch<double>& run : apart()) {
      RunBatch<double>::Detectors stages;
      for (const std::size_t d : others) stages.push_back(of_one(detectors[d]));
      auto of_run = run.answers(stages, levels, from);
      for (std::size_t i = 0; i < others.size(); ++i)
        all[others[i]].push_back(std::move(of_run[i].front()));
    }
    return all;
  }

  std::vector<Eigen::VectorXd> largest_statistic(const Asked& detector, double from) override {
    return of_each<Eigen::VectorXd>(detector, [&](const auto& batch, auto& stage) {
      auto most = stage.statistic();
      require(most.size() == robot_.dof(), "largest_statistic() is of a calibratable detector");
      most.setZero();
      batch.watch(stage, from, [&] { most = most.cwiseMax(stage.statistic()).eval(); });
      return most;
    });
  }

  std::vector<Eigen::MatrixXd> covariance(const Asked& detector, double from) override {
    return of_each<Eigen::MatrixXd>(detector, [&](const auto& batch, auto& stage) {
      using Scalar = typename std::decay_t<decltype(stage.change())>::Scalar;
      using Sum = Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic, 0, kMostDof, kMostDof>;
      const int n = robot_.dof();
      Sum sum = Sum::Constant(n, n, Scalar(0));
      int count = 0;
      batch.watch(stage, from, [&] {
        const JointVec<Scalar> z = stage.change();
        require(z.size() == n, "covariance() is of a detector with a metric");
        for (int j = 0; j < n; ++j)
          for (int i = 0; i < n; ++i) sum(i, j) += z[i] * z[j];
        ++count;
      });
      return Sum(sum / Scalar(std::max(count, 1)));
    });
  }

 private:
  // of one clock, and of samples that a detector would use
  bool are_alike() const {
    return std::all_of(traces_.begin(), traces_.end(), [&](const Trace& t) {
      return t.t == traces_.front().t &&
             t.torque_at_instants == traces_.front().torque_at_instants &&
             within(t.qd.reshaped(), kMeasurementLimit) &&
             within(t.tau.reshaped(), kMeasurementLimit);
    });
  }

  std::vector<std::string> estimate_at_once(EstimatorStage<Lanes>& stage) {
    lanes_->run(stage);
    std::vector<std::string> why;
    const auto soundness = lanes_->soundness();
    for (std::size_t i = 0; i < traces_.size(); ++i)
      why.push_back(soundness[i].why(traces_[i].size()));
    LeftOut left_out = lanes_->left_out();
    at_once_ = left_out.has_value();
    if (at_once_) lanes_->leave_out(*std::move(left_out));
    one_by_one_ = false;
    return why;
  }

  std::unique_ptr<DetectorStage<>> of_one(const Asked& detector) const {
    return robot_.detector(detector.detector, detector.settings);
  }
  // null unless it can go on at once
  std::unique_ptr<DetectorStage<Lanes>> of_runs(const Asked& detector) const {
    return at_once_ ? robot_.detector_of_runs(detector.detector, detector.settings) : nullptr;
  }

  // each run for itself
  std::vector<RunBatch<double>>& alone() {
    if (alone_.empty())
      for (const Trace& t : traces_) alone_.emplace_back(columns_of(t));
    return alone_;
  }

  // the same, with estimates that were made at once
  const std::vector<RunBatch<double>>& apart() {
    if (one_by_one_) return alone();
    for (std::size_t i = 0; i < traces_.size(); ++i) {
      RunBatch<double>& one = alone()[i];
      for (std::size_t k = 0; k < one.size(); ++k) {
        for (int j = 0; j < robot_.dof(); ++j)
          one.tau_ext(k)[j] = lanes_->tau_ext(k)[j][static_cast<int>(i)];
        one.status(k) = lanes_->status(k)[i];
        one.of_joints(k) = lanes_->of_joints(k)[i];
      }
    }
    one_by_one_ = true;
    return alone_;
  }

  // estimates that were made one by one, all at once
  void go_together(const std::vector<std::size_t>& left_out) {
    for (std::size_t k = 0; k < lanes_->size(); ++k) {
      for (int lane = 0; lane < kRuns; ++lane) {
        RunBatch<double>& one = alone_[in_lanes_->run_of(lane)];
        for (int j = 0; j < robot_.dof(); ++j) lanes_->tau_ext(k)[j].set(lane, one.tau_ext(k)[j]);
        lanes_->status(k)[static_cast<std::size_t>(lane)] = one.status(k);
        lanes_->of_joints(k)[static_cast<std::size_t>(lane)] = one.of_joints(k);
      }
    }
    lanes_->leave_out(left_out);
  }

  // what f(batch, stage) says of each run
  template <class Value, class F>
  std::vector<Value> of_each(const Asked& detector, const F& f) {
    std::vector<Value> values;
    if (const auto stage = of_runs(detector)) {
      const auto all = f(*lanes_, *stage);
      for (std::size_t i = 0; i < traces_.size(); ++i)
        values.push_back(all.unaryExpr([&](const Lanes& x) { return x[static_cast<int>(i)]; }));
      return values;
    }
    for (const RunBatch<double>& run : apart()) {
      const auto stage = of_one(detector);
      values.push_back(f(run, *stage));
    }
    return values;
  }

  const Robot& robot_;
  std::span<const Trace> traces_;
  std::vector<RunBatch<double>> alone_;   // each run, once it is asked for
  std::optional<LaneSamples> in_lanes_;   // all runs in lanes, if they are alike
  std::optional<RunBatch<Lanes>> lanes_;  // of them
  std::optional<SharedTerms> terms_;      // shared by estimators, from the second one on
  int asked_ = 0;                         // estimators asked for so far
  bool at_once_ = false,
       one_by_one_ = true;  // whether lanes_ has the estimates; whether alone_ has
};

}  // namespace

std::unique_ptr<Session> make_session(const Robot& robot, std::span<const Trace> traces) {
  for (const Trace& t : traces) robot.require_joints(t.dof());
  return std::make_unique<SessionOf>(robot, traces);
}

}  // namespace tauext
