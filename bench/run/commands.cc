// SPDX-License-Identifier: Apache-2.0
#include "bench/run/commands.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <sstream>
#include <stdexcept>
#include <string_view>

#include "bench/score/degradation.h"
#include "bench/seeds/golden.h"

namespace tauext {
namespace {

// the flags of bench/run/recording_flags.h that set these
std::string recording_flags(const SuiteOptions& o) {
  std::map<std::string, std::string> lists;  // of KEY=VALUE, by flag
  std::istringstream items(describe({o.sensors, o.model_error, o.recording.drives}));
  for (std::string item; items >> item;) {  // velocity_noise=0.001, or loadcell.noise=1
    const auto dot = item.find('.');
    const bool own = item.starts_with("loadcell.") || item.starts_with("model_error.") ||
                     item.starts_with("drives.");
    std::string& list = lists[own ? item.substr(0, dot) : "sensors"];
    list += (list.empty() ? "" : ",") + item.substr(own ? dot + 1 : 0);
  }
  std::string flags;
  for (const auto& [flag, list] : lists) flags += fmt::format(" --{} {}", flag, list);
  if (o.recording.Kp) flags += fmt::format(" --kp {}", *o.recording.Kp);
  if (o.recording.Kd) flags += fmt::format(" --kd {}", *o.recording.Kd);
  return flags + fmt::format(" --seed {}", o.sensors.seed);
}

}  // namespace

std::string record_and_replay(const std::string& golden, const SuiteOptions& options,
                              const Selection& selection) {
  SuiteOptions o = options;
  std::string name = golden;
  if (const auto at = name.find(kDegraded); at != std::string::npos) {
    name.erase(at, std::string_view(kDegraded).size());
    o.sensors = degraded_sensors();
    o.sensors.seed = options.sensors.seed;
  }
  const std::vector<Entry> all = golden_entries(selection);
  const auto e =
      std::find_if(all.begin(), all.end(), [&](const Entry& x) { return x.name() == name; });
  if (e == all.end()) {
    throw std::invalid_argument(fmt::format("unknown entry '{}'; see tauext-bench --list", golden));
  }
  if (!o.thresholds.sets.empty()) {
    throw std::invalid_argument("--commands: tauext-record and tauext-replay take no --thresholds");
  }
  return fmt::format(
      "  tauext-record --robot {0} --scenario {1}{2}{3} --out log.csv\n"
      "  tauext-replay log.csv --robot {0} --estimator {4}{5}{6} --out est.csv\n",
      is_robot_file(e->robot().name()) ? fmt::format("'{}'", e->robot().name()) : e->robot().name(),
      e->scenario().name, recording_flags(o),
      e->closed_loop() ? fmt::format(" --stop {}+{}", e->estimator(), e->detector()) : "",
      e->estimator(), e->detector().empty() ? "" : " --detector " + e->detector(),
      e->scenario().score_from > 0 ? fmt::format(" --score_from {}", e->scenario().score_from)
                                   : "");
}

}  // namespace tauext
