// SPDX-License-Identifier: Apache-2.0
#include "mjcf/record.h"

#include "mjcf/plant/plant.h"
#include "mjcf/simulation/run.h"

namespace tauext {

Trace simulate(const Model& model, const Scenario& scenario, const Recording& recording,
               const Sensors& sensors, const Supervisor& supervisor) {
  return detail::Run<Plant>(Plant(model), scenario, recording, sensors)(supervisor).value();
}

Trace record(const Model& model, const Scenario& scenario, const Sensors& sensors,
             const Recording& recording) {
  return measure(simulate(model, scenario, recording, sensors), sensors);
}

}  // namespace tauext
