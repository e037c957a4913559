// SPDX-License-Identifier: Apache-2.0
// 100 digits, for oracles.
#pragma once

#include <unsupported/Eigen/MPRealSupport>

namespace tauext::test {

using Precise = mpfr::mpreal;

inline void use_100_digits() {
  Precise::set_default_prec(mpfr::digits2bits(100));
}

}  // namespace tauext::test
