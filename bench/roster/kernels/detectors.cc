// SPDX-License-Identifier: Apache-2.0
#include "bench/roster/kernels/detectors.h"

#include "bench/roster/detector_list.h"
#include "estimators/math/pack.h"

namespace tauext::detail {

template <>
std::vector<DetectorType> roster_detectors<kRuns>(const Joints<>& torques) {
  std::vector<DetectorType> all;
  for_each_detector(
      [&]<class D>(std::type_identity<D>) { all.push_back(detector_type<D>(torques)); });
  return all;
}

template <>
std::unique_ptr<DetectorStage<Pack<kRuns>>> detector_of_runs<kRuns>(
    const Specification& s, const DetectorSettings& settings, const Joints<>& torques) {
  using Lanes = Pack<kRuns>;
  std::unique_ptr<DetectorStage<Lanes>> made;
  for_each_detector([&]<class D>(std::type_identity<D>) {
    if (s.name != D::kName) return;
    static_assert(DetectsRuns<D>);
    using OfRuns = typename D::template For<Lanes>;
    const auto p = made_detector<D>(s, settings, torques).parameters();
    made = std::make_unique<DetectorStageOf<OfRuns, Lanes>>(
        OfRuns(static_cast<int>(torques.size()), p));
  });
  return made;
}

}  // namespace tauext::detail
