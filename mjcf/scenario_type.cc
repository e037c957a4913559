// SPDX-License-Identifier: Apache-2.0
#include "mjcf/scenario_type.h"

namespace tauext {

Scenario quiet() {
  Scenario s;
  s.reference = [](double) { return Reference{}; };
  s.tau_ext = [](double) { return 0; };
  s.force = [](double, const Point&) -> Eigen::Vector3d { return Eigen::Vector3d::Zero(); };
  s.contact = [](double) { return false; };
  return s;
}

}  // namespace tauext
