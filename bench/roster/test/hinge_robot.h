// SPDX-License-Identifier: Apache-2.0
// hinge_arm() as a robot, and as the model that simulates it.
#pragma once

#include <fmt/format.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <memory>

#include "bench/roster/file_robot.h"
#include "bench/roster/test/hinge_arm.h"
#include "mjcf/record.h"

namespace tauext::test {

struct HingeRobot {
  explicit HingeRobot(int joints) {
    const auto path = std::filesystem::temp_directory_path() /
                      fmt::format("tauext_hinges_{}_{}.xml", ::getpid(), joints);
    std::ofstream(path) << hinge_arm(joints);
    robot = file_robot(path.string());
    model = load_mjcf(path.string());
    std::filesystem::remove(path);
  }
  std::unique_ptr<const Robot> robot;
  Model model;
};

}  // namespace tauext::test
