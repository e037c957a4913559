// SPDX-License-Identifier: Apache-2.0
// For tauext-gate: every estimator, detector and model of the roster, and what an arm from a file
// has.
#include "bench/kit/kernels.h"
#include "bench/roster/detector_list.h"
#include "bench/roster/roster.h"
#include "estimators/tree/tree_model.h"

namespace {

// a cooperative arm of 7 hinges, across and along in turn, about 1 m long and 19 kg
tauext::TreeModel<7> tree7() {
  tauext::TreeModel<7>::Parameters p;
  for (int i = 0; i < 7; ++i) {
    tauext::TreeJoint& j = p.joints[static_cast<std::size_t>(i)];
    const double size = 1 - 0.11 * i, side = i % 2 == 0 ? 1 : -1;
    j.parent = i - 1;
    j.axis = i % 2 == 0 ? tauext::Vec<3>::UnitZ() : tauext::Vec<3>::UnitY();
    j.position = {0, 0, i == 0 ? 0.15 : 0.2 * size};
    j.mass = 4 * size;
    j.center = {0.01 * size, 0.03 * side * size, 0.1 * size};
    j.inertia = tauext::Vec<3>(0.02, 0.018, 0.006).asDiagonal() * (size * size);
    j.armature = 0.1 * size;
    j.viscous = 0.5 * size;
    j.dry = 0.4 * size;
  }
  return tauext::TreeModel<7>(p);
}

template <class M>
void add_model_and_estimators(tauext::Kernels& kernels, const std::string& robot, const M& arm) {
  kernels.add_model(robot, arm);
  tauext::for_each_estimator(
      arm, [&](const auto& entry) { kernels.add_estimator(robot, arm, entry()); });
}

}  // namespace

TAUEXT_PLUGIN(kernels) {
  using namespace tauext;
  for_each_robot([&]<class M>(const std::string& robot, const M& arm) {
    add_model_and_estimators(kernels, robot, arm);
    for_each_detector(
        [&]<class D>(std::type_identity<D>) { kernels.add_detector(robot, arm, D(M::kDof)); });
  });
  add_model_and_estimators(kernels, "tree7", tree7());
}
