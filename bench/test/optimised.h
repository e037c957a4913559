// SPDX-License-Identifier: Apache-2.0
// Whether this build is quick enough for tests that simulate for minutes; Release runs them all.
#pragma once

namespace tauext::test {
#if defined(NDEBUG) && !defined(__SANITIZE_ADDRESS__)
inline constexpr bool kOptimised = true;
#else
inline constexpr bool kOptimised = false;
#endif
}  // namespace tauext::test
