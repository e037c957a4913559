// SPDX-License-Identifier: Apache-2.0
#include "bench/roster/detectors.h"

#include "bench/roster/detector_list.h"

namespace tauext::detail {

std::vector<DetectorType> roster_detectors(const JointVec<>& torques) {
  std::vector<DetectorType> all;
  for_each_detector(
      [&]<class D>(std::type_identity<D>) { all.push_back(detector_type<D>(torques)); });
  return all;
}

template <>
std::unique_ptr<DetectorStage<Pack<kRuns>>> detector_of_runs<kRuns>(
    const Specification& s, const DetectorSettings& settings, const JointVec<>& torques) {
  std::unique_ptr<DetectorStage<Pack<kRuns>>> made;
  for_each_detector([&]<class D>(std::type_identity<D>) {
    if (s.name != D::kName) return;
    static_assert(DetectsRuns<D>);
    using OfRuns = typename D::template For<Pack<kRuns>>;
    const auto p = made_detector<D>(s, settings, torques).parameters();
    made = std::make_unique<DetectorStageOf<OfRuns, Pack<kRuns>>>(
        OfRuns(static_cast<int>(torques.size()), p));
  });
  return made;
}

}  // namespace tauext::detail
