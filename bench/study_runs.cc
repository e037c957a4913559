// SPDX-License-Identifier: Apache-2.0
#include "bench/study_runs.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <stdexcept>

#include "bench/robot.h"

namespace tauext::study {

PlantKey plant_of(const Condition& c) {
  return {c.panel, c.degradation.model_error.friction};
}

Model model_of(const PlantKey& p) {
  return with_errors(wallmobot3_with_panel(p.panel), {.friction = p.friction});
}

Trace simulate(const Job& job, const Model& model) {
  return tauext::simulate(model, touched_wallmobot3(job.kind, job.seed));
}

Trace measured(const Trace& truth, Sensors sensors, const Job& job) {
  sensors.seed = 4 * job.seed + static_cast<std::uint64_t>(job.kind);
  return measure(truth, sensors);
}

std::vector<std::string> all_estimators() {
  std::vector<std::string> names = robot(kRobot).estimators;
  std::erase_if(names, [](const std::string& n) { return is_baseline(n); });
  return names;
}

std::vector<std::string> chosen(const char* what, const std::vector<std::string>& asked,
                                const std::vector<std::string>& known) {
  for (const std::string& name : asked) {
    if (std::count(known.begin(), known.end(), name) > 0) continue;
    throw std::invalid_argument(
        fmt::format("unknown {} '{}'; known: {}", what, name, fmt::join(known, ", ")));
  }
  return asked.empty() ? known : asked;
}

std::vector<std::string> condition_names() {
  std::vector<std::string> names;
  for (const Condition& c : conditions()) names.push_back(c.name);
  return names;
}

}  // namespace tauext::study
