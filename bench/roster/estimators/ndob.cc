// SPDX-License-Identifier: Apache-2.0
#include "estimators/ndob.h"

#include <tuple>

#include "bench/roster/estimator_type.h"
#include "bench/roster/printed_forms.h"

namespace tauext {
namespace {

#ifndef TAUEXT_FOR_TREES  // whose B no diagonal X fits
[[gnu::used]] constexpr auto kTypes =
    std::tuple_cat(compiled_types<Ndob>(), std::tuple(&roster_type<NdobRawSign, Testbed1>));
#endif

}  // namespace
}  // namespace tauext
