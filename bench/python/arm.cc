// SPDX-License-Identifier: Apache-2.0
#include "bench/python/arm.h"

#include <fmt/format.h>

#include <array>
#include <cstddef>
#include <stdexcept>
#include <type_traits>
#include <utility>

#include "bench/roster/roster.h"
#include "mjcf/plant/any_tree.h"

namespace tauext::python {
namespace {

template <class M>
class ArmOf final : public Arm {
 public:
  explicit ArmOf(const M& model) : model_(model) {}

  std::tuple<Eigen::MatrixXd, Eigen::VectorXd, Eigen::VectorXd, Eigen::VectorXd> terms(
      const Eigen::VectorXd& q, const Eigen::VectorXd& qd) const override {
    if (q.size() != M::kDof || qd.size() != M::kDof)
      throw std::invalid_argument(
          fmt::format("q and qd of {} joints, and the arm has {}", q.size(), M::kDof));
    const Vec<M::kDof> at = q, rate = qd;
    return {model_.inertia(at), model_.bias(at, rate), model_.momentum_bias(at, rate),
            model_.friction(rate)};
  }

 private:
  M model_;
};

template <std::size_t... I>
std::unique_ptr<const Arm> of_file(const Model& model, int joints, std::index_sequence<I...>) {
  using Make = std::unique_ptr<const Arm> (*)(const Model&);
  static constexpr std::array<Make, sizeof...(I)> kMakers = {
      [](const Model& m) -> std::unique_ptr<const Arm> {
        constexpr int N = static_cast<int>(I) + 1;
        return std::make_unique<ArmOf<AnyTree<N>>>(any_tree<N>(m));
      }...};
  return kMakers.at(static_cast<std::size_t>(joints) - 1)(model);
}

}  // namespace

std::unique_ptr<const Arm> arm_of(const Robot& robot) {
  std::unique_ptr<const Arm> arm;
  for_each_robot([&](const char* name, const auto& model) {
    if (robot.name() == name) arm = std::make_unique<ArmOf<std::decay_t<decltype(model)>>>(model);
  });
  if (arm) return arm;
  return of_file(robot.model(), robot.dof(), std::make_index_sequence<kMaxFileJoints>());
}

}  // namespace tauext::python
