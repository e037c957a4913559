// SPDX-License-Identifier: Apache-2.0
#include "bench/roster/pair.h"

#include <algorithm>
#include <utility>

namespace tauext {

void Pair::reset() noexcept {
  estimator_->reset();
  if (detector_) detector_->reset();
}

StepResult Pair::step(double t, const double* q, const double* qd, const double* tau,
                      double* tau_ext) noexcept {
  StepResult out;
  run({estimator_->joints(), 1, &t, q, qd, tau}, {tau_ext, &out.status, &out.joints},
      {&out.detection, 1});
  return out;
}

void Pair::run(const SampleColumns<>& in, const EstimateColumns<>& out,
               std::span<Detection> detections) {
  estimator_->run(in, out);
  if (detector_) detector_->run({in, out.tau_ext, out.status}, detections);
}

Output Pair::run(const Trace& trace) {
  const auto samples = static_cast<std::size_t>(trace.size());
  Output out{Eigen::MatrixXd(trace.dof(), trace.size()), std::vector<Status>(samples), {}, {}};
  std::vector<std::uint8_t> joints(samples);
  std::vector<Detection> detections(detector_ ? samples : 0);
  reset();
  run(columns_of(trace), {out.tau_ext.data(), out.status.data(), joints.data()}, detections);
  for (std::size_t k = 0; k < samples; ++k) out.counts.add(out.status[k], joints[k]);
  for (const Detection& d : detections) out.marks.push_back(d.mark);
  return out;
}

Runner::Runner(Pair pair, const Trace& trace)
    : pair_(std::move(pair)),
      tau_ext_(static_cast<std::size_t>(kBatch * trace.dof())),
      status_(kBatch),
      joints_(kBatch),
      detections_(kBatch) {
  samples_.t = trace.t;
  samples_.q = trace.q;
  samples_.qd = trace.qd;
  samples_.tau = trace.tau;
}

Output Runner::run() {
  next_ = 0;
  return pair_.run(samples_);
}

void Runner::batch() {
  const SampleColumns<> all = columns_of(samples_);
  for (std::size_t done = 0; done < kBatch;) {
    if (next_ == 0) pair_.reset();
    const std::size_t n = std::min<std::size_t>(kBatch - done, all.size - next_);
    pair_.run(all.part(next_, n), {tau_ext_.data(), status_.data(), joints_.data()}, detections_);
    done += n;
    next_ = next_ + n == all.size ? 0 : next_ + n;
  }
}

}  // namespace tauext
