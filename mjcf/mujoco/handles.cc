// SPDX-License-Identifier: Apache-2.0
#include "mjcf/mujoco/handles.h"

#include <fmt/format.h>

#include "mjcf/mujoco/mujoco_functions.h"
#include "mjcf/trace/printable.h"

namespace tauext {

Model owned(mjModel* m) {
  return {m, [](const mjModel* p) { mj_deleteModel(const_cast<mjModel*>(p)); }};
}

void DeleteState::operator()(mjData* d) const {
  mj_deleteData(d);
}

State initial_state(const mjModel& m) {
  State d(mj_makeData(&m));
  mj_forward(&m, d.get());
  return d;
}

Eigen::MatrixXd mass_matrix(const mjModel& m, const mjData& d) {
  const Eigen::MatrixXd identity = Eigen::MatrixXd::Identity(m.nv, m.nv);
  Eigen::MatrixXd M(m.nv, m.nv);
  for (int i = 0; i < m.nv; ++i) mj_mulM(&m, &d, M.col(i).data(), identity.col(i).data());
  return M;
}

std::string element_name(const mjModel& m, int kind, int id) {
  const char* const name = id < 0 ? nullptr : mj_id2name(&m, kind, id);
  return name == nullptr ? "" : printable_name(name);
}

std::string joint_name(const mjModel& m, int joint) {
  const std::string name = element_name(m, mjOBJ_JOINT, joint);
  return fmt::format("joint {}{}", joint + 1, name.empty() ? "" : " '" + name + "'");
}

std::string mujoco_version() {
  return mj_versionString();
}

}  // namespace tauext
