// SPDX-License-Identifier: Apache-2.0
#include "mjcf/record.h"

#include "mjcf/plant/coordinates.h"
#include "mjcf/plant/plant.h"
#include "mjcf/simulation/run.h"

namespace tauext {

Trace simulate(const Model& model, const Scenario& scenario, const Recording& recording,
               const Sensors& sensors, const Supervisor& supervisor) {
  const bool scaled = recording.drives.any() || !sensors.torque.ideal();
  const Eigen::VectorXd usual = scaled ? usual_torque_of(model) : Eigen::VectorXd();
  return detail::Run<Plant>(Plant(model), scenario, recording, sensors, usual)(supervisor).value();
}

Trace record(const Model& model, const Scenario& scenario, const Sensors& sensors,
             const Recording& recording) {
  return measure(simulate(model, scenario, recording, sensors), sensors);
}

}  // namespace tauext
