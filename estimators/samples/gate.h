// SPDX-License-Identifier: Apache-2.0
/// @file
/// The gate of a filter: samples that it finds too unlikely are left out.
#pragma once

#include <cstdint>

#include "estimators/math/lanes.h"
#include "estimators/parameters.h"
#include "estimators/types.h"

namespace tauext {

/// The gate of a filter, as its Parameters list it.
template <class P>
constexpr auto gate_field() {
  return Field{"gate", &P::gate, "1", 1, 1e12, "larger believes larger jumps"};
}

/// Which joints' innovation has jumped beyond the gate [1], in standard deviations, bit 0 for the
/// first: (innovation_i - expected_i)^2 > gate^2 variance_i. Not the innovation alone: a load that
/// a slow filter has not found yet makes that as large as any outlier, but bit by bit.
template <int N, class Scalar>
[[gnu::always_inline]] inline std::uint8_t beyond(const Scalar& gate,
                                                  const Vec<N, Scalar>& innovation,
                                                  const Vec<N, Scalar>& expected,
                                                  const Vec<N, Scalar>& variance) noexcept {
  unsigned mask = 0;
#pragma GCC unroll 8
  for (int j = 0; j < N; ++j) {
    const Scalar jump = innovation[j] - expected[j];
    mask |= static_cast<unsigned>(any(jump * jump > gate * gate * variance[j])) << j;
  }
  return static_cast<std::uint8_t>(mask);
}

}  // namespace tauext
