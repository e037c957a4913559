// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <stdexcept>

#include "bench/detection_study.h"
#include "bench/study_runs.h"

namespace tauext {
namespace {

Degradation noise(double velocity_noise) {
  Degradation d;
  d.sensors.velocity_noise = velocity_noise;
  return d;
}

Degradation hysteresis() {
  Degradation d = noise(1e-4);
  d.sensors.loadcell.hysteresis = 0.002;  // of 3000 N m
  return d;
}

Degradation dry_friction() {
  Degradation d = noise(1e-4);
  d.model_error.friction = 5;  // [N m]
  return d;
}

}  // namespace

const std::vector<Condition>& conditions() {
  static const std::vector<Condition> all = {
      {"known_0", "no panel, and the estimators know", 0, 0, noise(1e-4)},
      {"known_50", "a panel of 50 kg, known", 50, 50, noise(1e-4)},
      {"known_150", "a panel of 150 kg, known", 150, 150, noise(1e-4)},
      {"unknown_50", "50 kg, and the estimators believe in none", 50, 0, noise(1e-4)},
      {"unknown_150", "150 kg, and the estimators believe in none", 150, 0, noise(1e-4)},
      {"noise_known_0", "no panel, known; velocity noise 1e-3 rad/s", 0, 0, noise(1e-3)},
      {"noise_known_150", "150 kg, known; velocity noise 1e-3 rad/s", 150, 150, noise(1e-3)},
      {"noise_unknown_150", "150 kg, unknown; velocity noise 1e-3 rad/s", 150, 0, noise(1e-3)},
      {"hysteresis", "150 kg, known; torque sensors with 6 N m of hysteresis", 150, 150,
       hysteresis()},
      {"dry_friction", "150 kg, known; 5 N m of dry friction that the estimators do not know", 150,
       150, dry_friction()},
  };
  return all;
}

const Condition& condition(const std::string& name) {
  for (const Condition& c : conditions()) {
    if (c.name == name) return c;
  }
  throw std::invalid_argument(fmt::format("unknown condition '{}'; known: {}", name,
                                          fmt::join(study::condition_names(), ", ")));
}

}  // namespace tauext
