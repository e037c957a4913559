// SPDX-License-Identifier: Apache-2.0
#include "bench/live/options.h"

#include <fmt/format.h>

#include <cmath>
#include <stdexcept>

#include "lcmtypes/emitter.h"
#include "lcmtypes/lcm_url.h"
#include "lcmtypes/reading.h"
#include "lcmtypes/transport.h"
#include "mjcf/trace/known.h"

namespace tauext::live {

void check(const Options& o, bool listen) {
  const auto require = [](bool good, const std::string& what) {
    if (!good) throw std::invalid_argument(what + "; see tauext-live --help");
  };
  require(std::isfinite(o.pace.duration) && o.pace.duration >= 0,
          fmt::format("--duration {}: 0 s or more", o.pace.duration));
  require(!o.page || (*o.page >= 0 && *o.page <= 65535),
          fmt::format("--page {}: a port, 1 to 65535, or 0 for any", o.page.value_or(0)));
  const bool receives = listen || !o.subscribe.empty();
  require(!receives || !lcm_url(o.url).starts_with("memq://"),
          "memq:// does not leave a process: nothing can arrive");
  const std::string url = lcm_url(o.url);
  require(!receives || log_of(url).empty() || url.find("mode=") == url.npos,
          fmt::format("--lcm {}: a log that is read has no mode; leave it out", o.url));
  const int sources = listen + !o.scenario.empty() + !o.from.empty() + !o.subscribe.empty();
  require(sources == 1, "exactly one of --scenario, --from, --subscribe and --listen is required");
  require(o.thresholds.empty() || !o.detector.empty(), "--thresholds goes with --detector");
  if (listen) {
    require(o.robot.empty() && o.estimators.empty() && o.detector.empty() && o.wrench.empty(),
            "--listen shows streams and estimates nothing");
    return;
  }
  require(!o.subscribe.ends_with('*'), fmt::format("--subscribe {}: one channel", o.subscribe));
  require(!o.robot.empty(), "--robot is required");
  require(!o.estimators.empty(), "--estimator is required");
  refuse_twice("estimator", o.estimators);  // before anything is simulated
  require(o.pace.speed >= 1e-3 && o.pace.speed <= 1e3,
          fmt::format("--speed {}: 0.001 to 1000", o.pace.speed));
  require(o.rate >= 0 && o.rate <= 1e6, fmt::format("--rate {}: 0 to 1e6 a second", o.rate));
  message_type(o.type);
  for (const std::string& e : o.estimators) {
    require(o.subscribe != kEstimateChannel + e,
            fmt::format("--subscribe {}: its own estimates would come back to it", o.subscribe));
  }
}

}  // namespace tauext::live
