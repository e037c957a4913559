// SPDX-License-Identifier: Apache-2.0
#include "bench/score/bandwidth.h"

#include <cmath>
#include <complex>
#include <numbers>

#include "bench/score/score.h"

namespace tauext::metrics {
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

}  // namespace tauext::metrics
