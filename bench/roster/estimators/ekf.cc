// SPDX-License-Identifier: Apache-2.0
#include "estimators/ekf.h"

#include <tuple>

#include "bench/roster/estimator_type.h"
#include "bench/roster/printed_forms.h"

namespace tauext {
namespace {

[[gnu::used]] constexpr auto kEkf = compiled_types<Ekf>();
#ifndef TAUEXT_FOR_TREES
[[gnu::used]] constexpr auto kOthers =
    std::tuple(&roster_type<EkfHonest, WallMoBot3>, &roster_type<EkfZeroStart, Testbed1>,
               &roster_type<EkfRawSign, Testbed1>);
#endif

}  // namespace
}  // namespace tauext
