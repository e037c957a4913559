// SPDX-License-Identifier: Apache-2.0
#include "mjcf/mujoco/measured.h"

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

}  // namespace tauext
