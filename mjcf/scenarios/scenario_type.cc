// SPDX-License-Identifier: Apache-2.0
#include "mjcf/scenarios/scenario_type.h"

namespace tauext {

Scenario quiet() {
  Scenario s;
  s.reference = [](double, int) { return Reference{}; };
  s.tau_ext = [](double, int) { return 0; };
  s.force = [](double, const Point&) -> Eigen::Vector3d { return Eigen::Vector3d::Zero(); };
  s.contact = [](double, const Point&) { return false; };
  return s;
}

}  // namespace tauext
