// SPDX-License-Identifier: Apache-2.0
#include "bench/score/metrics.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <utility>

namespace tauext {
namespace metrics {
namespace {

// first sample that counts
Eigen::Index first_from(const Times& t, double from) {
  return std::lower_bound(t.begin(), t.end(), from) - t.begin();
}

Eigen::RowVectorXd error(const Times& t, const Signal& truth, const Signal& estimate, double from) {
  const Eigen::Index n = truth.size() - first_from(t, from);
  return estimate.tail(n) - truth.tail(n);
}

// [s] when the signal first reaches level in the direction up, from sample `start` on
double crossing(const Times& t, const Signal& x, Eigen::Index start, double level, bool up) {
  for (Eigen::Index k = start; k < x.size(); ++k) {
    if (up ? x[k] < level : x[k] > level) continue;
    if (k == start) return t[k];
    const double part = std::clamp((level - x[k - 1]) / (x[k] - x[k - 1]), 0., 1.);
    return t[k - 1] + part * (t[k] - t[k - 1]);
  }
  return kNoValue;
}

// mean squared estimate(t_k) - truth(t_k-shift), every stride-th sample
double mismatch(const Signal& truth, const Signal& estimate, Eigen::Index first, Eigen::Index shift,
                Eigen::Index stride) {
  double sum = 0;
  for (Eigen::Index k = first; k < truth.size(); k += stride) {
    const double e = estimate[k] - truth[k - shift];
    sum += e * e;
  }
  return sum;
}

}  // namespace

double rmse(const Times& t, const Signal& truth, const Signal& estimate, double from) {
  return std::sqrt(error(t, truth, estimate, from).array().square().mean());
}

double bias(const Times& t, const Signal& truth, const Signal& estimate, double from) {
  return error(t, truth, estimate, from).mean();
}

double max_error(const Times& t, const Signal& truth, const Signal& estimate, double from) {
  return error(t, truth, estimate, from).cwiseAbs().maxCoeff();
}

double time_of_max_error(const Times& t, const Signal& truth, const Signal& estimate, double from) {
  const Eigen::RowVectorXd e = error(t, truth, estimate, from).cwiseAbs();
  if (e.size() == 0) return kNoValue;
  Eigen::Index at = 0;
  e.maxCoeff(&at);
  return t[first_from(t, from) + at];
}

double noise(const Times& t, const Signal& ideal, const Signal& noisy, double from) {
  const Eigen::RowVectorXd e = error(t, ideal, noisy, from);
  return std::sqrt((e.array() - e.mean()).square().mean());
}

double final_error(const Times& t, const Signal& truth, const Signal& estimate) {
  return bias(t, truth, estimate, t.back() - 1);
}

StepResponse step_response(const Times& t, const Signal& truth, const Signal& estimate) {
  Eigen::Index k = 0;
  const Eigen::Index n = truth.size();
  if (n < 2) return {kNoValue, kNoValue, kNoValue, kNoValue};
  (truth.tail(n - 1) - truth.head(n - 1)).cwiseAbs().maxCoeff(&k);
  const double a = truth[k], b = truth[k + 1], step = b - a;
  ++k;  // the first sample of level b, t_s = t[k]
  if (step == 0) return {kNoValue, kNoValue, kNoValue, kNoValue};
  Eigen::Index end = k + 1;  // of level b
  while (end < n && std::abs(truth[end] - truth[end - 1]) < std::abs(step) / 2) ++end;

  StepResponse r;
  const double at_10 = crossing(t, estimate.head(end), k, a + 0.1 * step, step > 0);
  const double at_90 = crossing(t, estimate.head(end), k, a + 0.9 * step, step > 0);
  r.rise = at_90 - at_10;
  r.rise_0_90 = at_90 - t[k];
  r.overshoot = std::max(0., ((estimate.segment(k, end - k).array() - b) / step).maxCoeff() * 100);

  const double band = 0.02 * std::abs(step);
  Eigen::Index last_outside = end - 1;
  while (last_outside >= k && std::abs(estimate[last_outside] - b) <= band) --last_outside;
  if (last_outside == end - 1) {
    r.settling = kNoValue;
  } else if (last_outside < k) {
    r.settling = 0;
  } else {
    const double edge = estimate[last_outside] > b ? b + band : b - band;
    r.settling = crossing(t, estimate, last_outside, edge, estimate[last_outside] < b) - t[k];
  }
  return r;
}

double lag(const Times& t, const Signal& truth, const Signal& estimate, double from) {
  constexpr double kLongest = 2;        // [s]
  constexpr Eigen::Index kCoarse = 16;  // samples
  if (t.size() < 2 || truth.maxCoeff() == truth.minCoeff()) return kNoValue;
  if (estimate.maxCoeff() == estimate.minCoeff()) return kNoValue;
  const Eigen::Index first = first_from(t, t.front() + from + kLongest);
  const double Ts = (t.back() - t.front()) / static_cast<double>(t.size() - 1);
  const auto longest = static_cast<Eigen::Index>(kLongest / Ts);
  if (first >= truth.size() || longest > first) return kNoValue;

  const auto best = [&](Eigen::Index from_shift, Eigen::Index to_shift, Eigen::Index step) {
    Eigen::Index at = from_shift;
    double least = std::numeric_limits<double>::infinity();
    for (Eigen::Index s = from_shift; s <= to_shift; s += step) {
      const double m = mismatch(truth, estimate, first, s, step);
      if (m < least) least = m, at = s;
    }
    return at;
  };
  const Eigen::Index coarse = best(0, longest, kCoarse);
  const Eigen::Index fine =
      best(std::max<Eigen::Index>(0, coarse - kCoarse), std::min(longest, coarse + kCoarse), 1);
  return fine == longest ? kNoValue : static_cast<double>(fine) * Ts;
}

namespace {

// the spectrum at w [rad/s], which turns by `turn` from sample to sample
std::complex<double> spectrum(const Signal& x, double w, double h) {
  const std::complex<double> turn = std::polar(1., -w * h);
  std::complex<double> sum = 0, phase = 1;
  for (int k = 0; k < x.size(); ++k) {
    sum += x[k] * phase;
    phase *= turn;
    if (k % 1024 == 0) phase = std::polar(1., -w * h * (k + 1));  // round-off does not pile up
  }
  return sum * h;
}

bool evenly_spaced(const Times& t, double h) {
  for (std::size_t k = 1; k < t.size(); ++k) {
    if (std::abs(t[k] - t[k - 1] - h) > 0.01 * h) return false;
  }
  return true;
}

}  // namespace

double force_rmse(const ArmForces& arm, const Trace& trace, const Eigen::MatrixXd& estimate,
                  double from) {
  double sum = 0;
  int count = 0;
  for (int k = 0; k < trace.force.cols(); ++k) {
    if (trace.t[k] < from) continue;
    const Eigen::VectorXd q = trace.q.col(k), tau_ext = estimate.col(k);
    const Eigen::VectorXd truth = arm.torque(q, trace.force.col(k));
    const Vec<3> seen = arm.at_site(q.data(), truth.data()).force;
    sum += (arm.at_site(q.data(), tau_ext.data()).force - seen).squaredNorm();
    ++count;
  }
  return count > 0 ? std::sqrt(sum / count) : kNoValue;
}

double bandwidth(const Times& t, const Signal& truth, const Signal& estimate) {
  const double h = t.size() < 2 ? 0 : (t.back() - t.front()) / static_cast<double>(t.size() - 1);
  if (!(h > 0) || !evenly_spaced(t, h)) return kNoValue;
  constexpr double kLeast = 0.7, kMost = 280;  // [rad/s]
  constexpr double kStep = 1.1;                // from one frequency to the next
  constexpr int kLines = 5;                    // of a band
  // a sweep has far more than this everywhere; a step at 280 rad/s, some hundred times as much
  const double duration = t.back() - t.front();
  const double least_power = 1e-9 * truth.squaredNorm() * h * duration;
  double w_before = kLeast, gain_before = 1;
  for (double w = kLeast; w <= kMost; w *= kStep) {
    std::complex<double> cross = 0;
    double power = 0;
    for (int i = 0; i < kLines; ++i) {
      const double line = w * std::pow(kStep, (i - (kLines - 1) / 2.) / kLines);
      const std::complex<double> x = spectrum(truth, line, h);
      cross += spectrum(estimate, line, h) * std::conj(x);
      power += std::norm(x);
    }
    if (!(power > least_power)) return kNoValue;
    const double gain = std::abs(cross) / power;
    if (gain < std::numbers::sqrt2 / 2 && w == kLeast) return kNoValue;
    if (gain < std::numbers::sqrt2 / 2) {
      // on a straight line in the logarithms
      const double share =
          std::log(gain_before * std::numbers::sqrt2) / std::log(gain_before / gain);
      return w_before * std::pow(w / w_before, share);
    }
    w_before = w;
    gain_before = gain;
  }
  return kNoValue;
}

}  // namespace metrics

namespace {

// a value of(truth, estimate) for each joint
template <class OfJoint>
void add_by_joint(Metric m, const Eigen::MatrixXd& truth, const Eigen::MatrixXd& estimate,
                  Score& score, OfJoint&& of) {
  Score::Joints values;
  for (Eigen::Index j = 0; j < truth.rows(); ++j)
    values.emplace_back(of(truth.row(j), estimate.row(j)));
  score.set_joints(m, std::move(values));
}

// the same of the joints whose truth moves; the others have nothing to answer
template <class OfJoint>
void add_answers(Metric m, const Eigen::MatrixXd& truth, const Eigen::MatrixXd& estimate,
                 Score& score, OfJoint&& of) {
  if (truth.size() == 0) return;
  const Eigen::VectorXd moves = truth.rowwise().maxCoeff() - truth.rowwise().minCoeff();
  const double least = 1e-9 * moves.maxCoeff();
  Score::Joints values;
  for (Eigen::Index j = 0; j < truth.rows(); ++j) {
    values.emplace_back();
    if (moves[j] > least) values.back() = of(truth.row(j), estimate.row(j));
  }
  score.set_joints(m, std::move(values));
}

void add_step_response(const Trace& trace, const Output& out, Score& score) {
  const auto add = [&](Metric m, double metrics::StepResponse::*figure) {
    add_answers(m, trace.tau_ext, out.tau_ext, score, [&](const auto& truth, const auto& estimate) {
      return metrics::step_response(trace.t, truth, estimate).*figure;
    });
  };
  add(Metric::kRise, &metrics::StepResponse::rise);
  add(Metric::kRise0To90, &metrics::StepResponse::rise_0_90);
  add(Metric::kSettling, &metrics::StepResponse::settling);
  add(Metric::kOvershoot, &metrics::StepResponse::overshoot);
  add_by_joint(Metric::kFinal, trace.tau_ext, out.tau_ext, score,
               [&](const auto& truth, const auto& estimate) {
                 return std::abs(metrics::final_error(trace.t, truth, estimate));
               });
}

}  // namespace

void add_error_metrics(const Trace& trace, const Output& out, double from, Score& score) {
  const auto add = [&](Metric m, auto&& error) {
    add_by_joint(m, trace.tau_ext, out.tau_ext, score,
                 [&](const auto& truth, const auto& estimate) {
                   return error(trace.t, truth, estimate, from);
                 });
  };
  add(Metric::kRmse, metrics::rmse);
  add(Metric::kMax, metrics::max_error);
  add(Metric::kBias, [](auto&&... signals) { return std::abs(metrics::bias(signals...)); });
  // of the joint whose error is the largest
  const Score::Joints& max = score.joints(Metric::kMax);
  double largest = -1;
  for (int j = 0; j < trace.dof(); ++j) {
    if (!(*max[j] > largest)) continue;
    largest = *max[j];
    score.set(Metric::kMaxAt,
              metrics::time_of_max_error(trace.t, trace.tau_ext.row(j), out.tau_ext.row(j), from));
  }
}

void add_noise_metric(const Trace& trace, const Output& ideal, const Output& noisy, double from,
                      Score& score) {
  if (ideal.status.size() != noisy.status.size()) return;
  add_by_joint(Metric::kNoise, ideal.tau_ext, noisy.tau_ext, score,
               [&](const auto& a, const auto& b) { return metrics::noise(trace.t, a, b, from); });
}

void add_response_metrics(const Trace& trace, const Output& out, const Scenario& scenario,
                          Score& score) {
  if (scenario.response == Response::kStep) add_step_response(trace, out, score);
  if (scenario.response == Response::kLag) {
    add_answers(Metric::kLag, trace.tau_ext, out.tau_ext, score,
                [&](const auto& truth, const auto& estimate) {
                  return metrics::lag(trace.t, truth, estimate, scenario.score_from);
                });
  }
  if (scenario.response == Response::kBandwidth) {
    add_answers(Metric::kBandwidth, trace.tau_ext, out.tau_ext, score,
                [&](const auto& truth, const auto& estimate) {
                  return metrics::bandwidth(trace.t, truth, estimate);
                });
  }
}

}  // namespace tauext
