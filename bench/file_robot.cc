// SPDX-License-Identifier: Apache-2.0
#include "bench/file_robot.h"

#include <fmt/format.h>

#include <stdexcept>

#include "bench/file_robot_of.h"

namespace tauext {

Robot file_robot(const std::string& path) {
  const Model model = load_mjcf(path);
  try {
    switch (ArmDynamics(model).dof()) {
      case 1:
        return file_robot_of<1>(path, model);
      case 2:
        return file_robot_of<2>(path, model);
      case 3:
        return file_robot_of<3>(path, model);
      case 4:
        return file_robot_of<4>(path, model);
      case 5:
        return file_robot_of<5>(path, model);
      case 6:
        return file_robot_of<6>(path, model);
      case kMaxFileJoints:
        return file_robot_of<kMaxFileJoints>(path, model);
      default:
        throw std::invalid_argument(
            fmt::format("{} joints: 1 to {} are supported", model->nv, kMaxFileJoints));
    }
  } catch (const std::invalid_argument& e) {
    throw std::invalid_argument(fmt::format("{}: {}", path, e.what()));
  }
}

}  // namespace tauext
