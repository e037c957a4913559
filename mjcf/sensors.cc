// SPDX-License-Identifier: Apache-2.0
#include "mjcf/sensors.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <random>
#include <stdexcept>

namespace tauext {
namespace {

// N(0, 1) by Box and Muller: the sequence of std::normal_distribution is each library's own
class Gaussian {
 public:
  Gaussian(std::uint64_t seed, std::uint64_t channel) {
    std::seed_seq seeds{static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32),
                        static_cast<std::uint32_t>(channel)};
    generator_.seed(seeds);
  }

  double operator()() {
    const double u = uniform(), v = uniform();
    return std::sqrt(-2 * std::log(u)) * std::cos(2 * std::numbers::pi * v);
  }

 private:
  // in (0, 1]
  double uniform() { return (static_cast<double>(generator_() >> 11) + 1) * 0x1p-53; }

  std::mt19937_64 generator_;
};

void add_noise(Eigen::MatrixXd& m, double deviation, std::uint64_t seed,
               std::uint64_t first_channel) {
  if (deviation == 0) return;
  for (int j = 0; j < m.rows(); ++j) {
    Gaussian noise(seed, first_channel + j);
    for (int k = 0; k < m.cols(); ++k) m(j, k) += deviation * noise();
  }
}

void check(const char* name, double value) {
  if (value >= 0 && std::isfinite(value)) return;
  throw std::invalid_argument(fmt::format("{} must be 0 or positive, not {}", name, value));
}

}  // namespace

Trace measure(const Trace& truth, const Sensors& s) {
  check("velocity noise [rad/s]", s.velocity_noise);
  check("encoder step [rad]", s.encoder_step);
  check("loadcell noise [N m]", s.loadcell_noise);
  constexpr std::uint64_t kVelocity = 100, kLoadcell = 200;  // channels
  Trace m = truth;
  add_noise(m.qd, s.velocity_noise, s.seed, kVelocity);
  add_noise(m.tau, s.loadcell_noise, s.seed, kLoadcell);
  if (s.encoder_step > 0) m.q = (m.q / s.encoder_step).array().round().matrix() * s.encoder_step;
  return m;
}

}  // namespace tauext
