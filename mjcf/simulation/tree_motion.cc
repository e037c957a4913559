// SPDX-License-Identifier: Apache-2.0
#include "mjcf/simulation/tree_motion.h"

#include <array>
#include <cstddef>
#include <utility>

namespace tauext {

namespace detail {
template <int N>
std::unique_ptr<const TreeMotion> tree_motion_of(const PlainArm& arm);  // tree_motion_of.h
}  // namespace detail

namespace {

using Make = std::unique_ptr<const TreeMotion> (*)(const PlainArm& arm);

template <std::size_t... I>
constexpr std::array<Make, sizeof...(I)> makes(std::index_sequence<I...>) {
  return {[](const PlainArm& arm) -> std::unique_ptr<const TreeMotion> {
    constexpr int kJoints = static_cast<int>(I) + 1;
    if constexpr (kJoints <= TAUEXT_FILE_JOINTS || kJoints == 3)  // as robots have that there are
      return detail::tree_motion_of<kJoints>(arm);
    else
      return nullptr;
  }...};
}

}  // namespace

std::unique_ptr<const TreeMotion> tree_motion(const PlainArm& arm) {
  static constexpr auto kOfJoints = makes(std::make_index_sequence<kMostCoordinates>());
  const auto joints = static_cast<std::size_t>(arm.tree.dof());
  return joints - 1 < kOfJoints.size() ? kOfJoints[joints - 1](arm) : nullptr;
}

}  // namespace tauext
