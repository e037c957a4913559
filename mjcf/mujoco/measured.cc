// SPDX-License-Identifier: Apache-2.0
#include "mjcf/mujoco/measured.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "mjcf/mujoco/mujoco_functions.h"

namespace tauext {

Measured measured(const mjModel& m, int joint) {
  const std::string name = "tauext:" + element_name(m, mjOBJ_JOINT, joint);
  const int id = mj_name2id(&m, mjOBJ_NUMERIC, name.c_str());
  const auto number = [&](int i) {
    return id < 0 || i >= m.numeric_size[id] ? 0. : m.numeric_data[m.numeric_adr[id] + i];
  };
  return {number(0), number(1), number(2)};
}

double rated_torque(const mjModel& m, int joint) {
  const std::string name = "tauext:rated:" + element_name(m, mjOBJ_JOINT, joint);
  const int id = mj_name2id(&m, mjOBJ_NUMERIC, name.c_str());
  if (id >= 0) return m.numeric_data[m.numeric_adr[id]];
  double rated = 0;
  for (int i = 0; i < m.nu; ++i) {
    if (m.actuator_trntype[i] != mjTRN_JOINT || m.actuator_trnid[2 * i] != joint) continue;
    double most = std::numeric_limits<double>::infinity();
    const auto within = [&](bool limited, const mjtNum* range) {
      if (limited) most = std::min(most, std::max(-range[0], range[1]));
    };
    within(m.actuator_ctrllimited[i], m.actuator_ctrlrange + 2 * i);
    within(m.actuator_forcelimited[i], m.actuator_forcerange + 2 * i);
    if (std::isfinite(most)) rated = std::max(rated, std::abs(m.actuator_gear[6 * i]) * most);
  }
  return rated;
}

}  // namespace tauext
