// SPDX-License-Identifier: Apache-2.0
#include "bench/score/metrics.h"

#include <algorithm>
#include <cmath>
#include <limits>
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

Errors errors(const Times& t, const Signal& truth, const Signal& estimate, double from) {
  Errors all;
  for (Eigen::Index k = first_from(t, from); k < truth.size(); ++k)
    all.take(estimate[k] - truth[k]);
  return all;
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

using Contiguous = Eigen::RowVectorXd;  // a row of a matrix is not, and slow

// sum of the squares of estimate(t_k) - truth(t_k-shift)
double mismatch(const Contiguous& truth, const Contiguous& estimate, Eigen::Index first,
                Eigen::Index shift) {
  const Eigen::Index n = truth.size() - first;
  return (estimate.tail(n) - truth.segment(first - shift, n)).squaredNorm();
}

// standard deviation of the same differences
double spread(const Contiguous& truth, const Contiguous& estimate, Eigen::Index first,
              Eigen::Index shift) {
  const Eigen::Index n = truth.size() - first;
  const Contiguous e = estimate.tail(n) - truth.segment(first - shift, n);
  return std::sqrt((e.array() - e.mean()).square().mean());
}

// sum of the squares of every stride-th difference
double rough_mismatch(const Contiguous& truth, const Contiguous& estimate, Eigen::Index first,
                      Eigen::Index shift, Eigen::Index stride) {
  double sum = 0;
  for (Eigen::Index k = first; k < truth.size(); k += stride) {
    const double e = estimate[k] - truth[k - shift];
    sum += e * e;
  }
  return sum;
}

}  // namespace

double rmse(const Times& t, const Signal& truth, const Signal& estimate, double from) {
  return errors(t, truth, estimate, from).rmse();
}

double bias(const Times& t, const Signal& truth, const Signal& estimate, double from) {
  return errors(t, truth, estimate, from).bias();
}

double max_error(const Times& t, const Signal& truth, const Signal& estimate, double from) {
  return errors(t, truth, estimate, from).max();
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

  StepResponse r{};
  const double at_10 = crossing(t, estimate.head(end), k, a + 0.1 * step, step > 0);
  const double at_90 = crossing(t, estimate.head(end), k, a + 0.9 * step, step > 0);
  r.rise = at_90 - at_10;
  r.rise_0_90 = at_90 - t[k];
  r.overshoot = std::max(0., ((estimate.segment(k, end - k).array() - b) / step).maxCoeff() * 100);

  const double band = 0.02 * std::abs(step);
  Eigen::Index last_outside = end - 1;
  while (last_outside >= k && std::abs(estimate[last_outside] - b) <= band) --last_outside;
  const double edge = last_outside < k || estimate[last_outside] < b ? b - band : b + band;
  if (last_outside == end - 1) {
    r.settling = kNoValue;
  } else if (last_outside >= k) {  // else from the beginning on
    r.settling = crossing(t, estimate, last_outside, edge, estimate[last_outside] < b) - t[k];
  }
  return r;
}

double lag(const Times& t, const Signal& of_truth, const Signal& of_estimate, double from) {
  // a first look tries each fourth delay, so that it sees the periods of quick sines, by each
  // sixteenth sample
  constexpr Eigen::Index kCoarse = 4, kStride = 16;
  const Contiguous truth = of_truth, estimate = of_estimate;
  if (t.size() < 2 || truth.maxCoeff() == truth.minCoeff()) return kNoValue;
  if (estimate.maxCoeff() == estimate.minCoeff()) return kNoValue;
  const Eigen::Index first = first_from(t, t.front() + from + kLongestLag);
  const double Ts = (t.back() - t.front()) / static_cast<double>(t.size() - 1);
  const auto longest = static_cast<Eigen::Index>(kLongestLag / Ts);
  if (first >= truth.size() || longest > first) return kNoValue;

  const auto left_at = [&](Eigen::Index s) { return mismatch(truth, estimate, first, s); };
  std::vector<double> coarse;
  for (Eigen::Index s = 0; s <= longest; s += kCoarse)
    coarse.push_back(rough_mismatch(truth, estimate, first, s, kStride));
  std::vector<std::pair<double, Eigen::Index>> minima;
  const auto n = static_cast<Eigen::Index>(coarse.size());
  for (Eigen::Index i = 0; i < n; ++i) {
    if ((i > 0 && coarse[i] > coarse[i - 1]) || (i + 1 < n && coarse[i] > coarse[i + 1])) continue;
    minima.emplace_back(std::numeric_limits<double>::infinity(), 0);
    for (Eigen::Index s = std::max<Eigen::Index>(0, (i - 1) * kCoarse);
         s <= std::min(longest, (i + 1) * kCoarse); ++s)
      minima.back() = std::min(minima.back(), {left_at(s), s});
  }
  // What is left, over the delay, has a valley at the delay of the estimate and, if the truth
  // repeats, at each period more: the first valley that is nearly as deep as any is the right one.
  // Within it noise makes many minima, and the deepest counts.
  const auto [least, place] = *std::min_element(minima.begin(), minima.end());
  const auto [lowest, highest] = std::minmax_element(coarse.begin(), coarse.end());
  const double depth = kStride * (*highest - *lowest);
  // sigma of noise makes a depth d uncertain by 2 sigma sqrt(d): three times that
  if (!(std::sqrt(depth) > 6 * spread(truth, estimate, first, place))) return kNoValue;
  const double good = least + 0.1 * depth;
  const auto valley =
      std::find_if(minima.begin(), minima.end(), [&](const auto& m) { return m.first <= good; });
  auto deepest = *valley;
  for (const int step : {-1, 1}) {
    for (Eigen::Index s = valley->second; s >= 0 && s <= longest; s += step) {
      const double left = left_at(s);
      if (left > good) break;
      deepest = std::min(deepest, {left, s});
    }
  }
  const Eigen::Index fine = deepest.second;
  return fine == longest ? kNoValue : static_cast<double>(fine) * Ts;
}

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
