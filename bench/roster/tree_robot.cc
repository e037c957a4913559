// SPDX-License-Identifier: Apache-2.0
#include "bench/roster/tree_robot.h"

#include <array>
#include <cstddef>
#include <utility>

#include "bench/roster/make_robot.h"
#include "mjcf/plant/any_tree.h"

namespace tauext::detail {
namespace {

using Make = std::unique_ptr<const Robot> (*)(const std::string& name, const Model& model);

template <std::size_t... I>
constexpr std::array<Make, sizeof...(I)> makes(std::index_sequence<I...>) {
  return {[](const std::string& name, const Model& model) {
    return make_robot(name, any_tree<static_cast<int>(I) + 1>(model), model);
  }...};
}

}  // namespace

std::unique_ptr<const Robot> tree_robot(int joints, const std::string& name, const Model& model) {
  static constexpr auto kOfJoints = makes(std::make_index_sequence<kMaxFileJoints>());
  return kOfJoints.at(static_cast<std::size_t>(joints) - 1)(name, model);
}

}  // namespace tauext::detail
