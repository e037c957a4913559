// SPDX-License-Identifier: Apache-2.0
#include "mjcf/mujoco/measured.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "mjcf/mujoco/mujoco_functions.h"

namespace tauext {

namespace {

// the numbers of custom's numeric of a joint; what is missing is 0
class Numeric {
 public:
  Numeric(const mjModel& m, const char* prefix, int joint)
      : m_(m),
        id_(mj_name2id(&m, mjOBJ_NUMERIC, (prefix + element_name(m, mjOBJ_JOINT, joint)).c_str())) {
  }

  double operator[](int i) const {
    return id_ < 0 || i >= m_.numeric_size[id_] ? 0. : m_.numeric_data[m_.numeric_adr[id_] + i];
  }

 private:
  const mjModel& m_;
  int id_;
};

}  // namespace

Measured measured(const mjModel& m, int joint) {
  const Numeric numbers(m, "tauext:", joint);
  return {numbers[0], numbers[1], numbers[2], numbers[3]};
}

Rated rated_of(const mjModel& m, int joint) {
  const Numeric numbers(m, "tauext:rated:", joint);
  Rated rated{numbers[0], numbers[1]};
  if (rated.torque > 0) return rated;
  for (int i = 0; i < m.nu; ++i) {
    if (m.actuator_trntype[i] != mjTRN_JOINT || m.actuator_trnid[2 * i] != joint) continue;
    double most = std::numeric_limits<double>::infinity();
    // simulated() switches the limits off, and leaves the ranges
    for (const mjtNum* range : {m.actuator_ctrlrange + 2 * i, m.actuator_forcerange + 2 * i})
      if (range[0] < range[1]) most = std::min(most, std::max(-range[0], range[1]));
    if (std::isfinite(most))
      rated.torque = std::max(rated.torque, std::abs(m.actuator_gear[6 * i]) * most);
  }
  return rated;
}

}  // namespace tauext
