// SPDX-License-Identifier: Apache-2.0
#include "bench/python/arm.h"

#include <array>
#include <cstddef>
#include <type_traits>
#include <utility>

#include "bench/roster/roster.h"
#include "mjcf/plant/any_tree.h"

namespace tauext::python {
namespace {

template <std::size_t... I>
std::shared_ptr<Arm> of_file(const Model& model, int joints, std::index_sequence<I...>) {
  using Make = std::shared_ptr<Arm> (*)(const Model&);
  static constexpr std::array<Make, sizeof...(I)> kMakers = {
      [](const Model& m) -> std::shared_ptr<Arm> {
        constexpr int N = static_cast<int>(I) + 1;
        return std::make_shared<ArmOf<AnyTree<N>>>(any_tree<N>(m));
      }...};
  return kMakers.at(static_cast<std::size_t>(joints) - 1)(model);
}

}  // namespace

std::shared_ptr<Arm> arm_of(const Robot& robot) {
  std::shared_ptr<Arm> arm;
  for_each_robot([&](const char* name, const auto& model) {
    if (robot.name() == name) arm = std::make_shared<ArmOf<std::decay_t<decltype(model)>>>(model);
  });
  if (arm) return arm;
  return of_file(robot.model(), robot.dof(), std::make_index_sequence<kMaxFileJoints>());
}

}  // namespace tauext::python
