// SPDX-License-Identifier: Apache-2.0
// Files of robots, in a folder of their own.
#pragma once

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>

namespace tauext::test {

class RobotFolder : public testing::Test {
 protected:
  RobotFolder() { std::filesystem::create_directories(folder_); }
  ~RobotFolder() override { std::filesystem::remove_all(folder_); }

  std::string put(const std::string& xml, const std::string& name = "robot.xml") const {
    std::ofstream(folder_ / name) << xml;
    return folder_ / name;
  }
  // a file with these bodies
  std::string body(const std::string& xml) const {
    return put("<mujoco><worldbody>" + xml + "</worldbody></mujoco>");
  }

  const std::filesystem::path folder_ =
      std::filesystem::path(testing::TempDir()) / fmt::format("robots_{}", ::getpid());
};

}  // namespace tauext::test
