// SPDX-License-Identifier: Apache-2.0
/// @file
/// THE list of detectors: one line here adds one to the benchmark, to tauext-replay and to the
/// conformance tests. Those of robots are detectors.h's; this is for who needs their types.
#pragma once

#include <type_traits>

#include "estimators/detectors/band_pass.h"
#include "estimators/detectors/clamping.h"
#include "estimators/detectors/contact_classifier.h"
#include "estimators/detectors/cusum.h"
#include "estimators/detectors/dynamic_threshold.h"
#include "estimators/detectors/energy.h"
#include "estimators/detectors/glr.h"
#include "estimators/detectors/high_pass.h"
#include "estimators/detectors/pan_tompkins.h"
#include "estimators/detectors/threshold.h"

namespace tauext {

/// Calls visit(std::type_identity<D>()) for the detectors that the suite runs behind every
/// estimator.
template <class Visit>
void for_each_suite_detector(Visit&& visit) {
  visit(std::type_identity<PanTompkins>());
  visit(std::type_identity<ContactClassifier>());
}

/// The same for those that stand in the studies alone: with all of them the suite's tables would
/// not end.
template <class Visit>
void for_each_study_detector(Visit&& visit) {
  visit(std::type_identity<Clamping>());
  visit(std::type_identity<Threshold>());
  visit(std::type_identity<DynamicThreshold>());
  visit(std::type_identity<HighPass>());
  visit(std::type_identity<BandPass>());
  visit(std::type_identity<Cusum>());
  visit(std::type_identity<Glr>());
  visit(std::type_identity<Energy>());
}

/// For all of them.
template <class Visit>
void for_each_detector(Visit&& visit) {
  for_each_suite_detector(visit);
  for_each_study_detector(visit);
}

}  // namespace tauext
