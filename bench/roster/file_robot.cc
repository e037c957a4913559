// SPDX-License-Identifier: Apache-2.0
#include "bench/roster/file_robot.h"

#include <fmt/format.h>

#include <stdexcept>

#include "mjcf/plant/tree.h"

namespace tauext {
namespace {

// the robot of that number of joints, N or more
template <int N>
std::unique_ptr<const Robot> robot_from(int joints, const std::string& path, const Model& model) {
  if (joints == N) return detail::file_robot_of<N>(path, model);
  if constexpr (N < kMaxFileJoints) return robot_from<N + 1>(joints, path, model);
  throw std::invalid_argument(
      fmt::format("{} joints: 1 to {} are supported", joints, kMaxFileJoints));
}

}  // namespace

std::unique_ptr<const Robot> file_robot(const std::string& path, const ImportOptions& options) {
  const Model model = load_mjcf(path, options);
  try {
    return robot_from<1>(static_cast<int>(tree_of(model).joints.size()), path, model);
  } catch (const std::invalid_argument& e) {
    throw std::invalid_argument(fmt::format("{}: {}", path, e.what()));
  }
}

}  // namespace tauext
