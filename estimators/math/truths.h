// SPDX-License-Identifier: Apache-2.0
/// @file
/// What comparisons of SIMD registers say. AVX-512 has a bit of each double for it, which GCC 12
/// does not use for what it is not asked to by name.
#pragma once

#ifdef __AVX__
#include <immintrin.h>
#endif

#include <cmath>
#include <cstdint>

#include "estimators/math/lanes.h"

namespace tauext::detail {

/// What a comparison of two registers of W doubles says, and what is chosen by it.
template <int W>
struct Truths {
  using Register = typename Registers<W>::Register;
  using Bits = typename Registers<W>::Bits;  ///< ~0 where it is so, else 0

  [[gnu::always_inline]] static Bits less(const Register& a, const Register& b) noexcept {
    return (Bits)(a < b);
  }
  [[gnu::always_inline]] static Bits at_most(const Register& a, const Register& b) noexcept {
    return (Bits)(a <= b);
  }
  [[gnu::always_inline]] static Bits equal(const Register& a, const Register& b) noexcept {
    return (Bits)(a == b);
  }
  [[gnu::always_inline]] static Bits no(const Bits& a) noexcept { return ~a; }
  [[gnu::always_inline]] static Register choose(const Bits& is, const Register& a,
                                                const Register& b) noexcept {
    return is ? a : b;
  }
  [[gnu::always_inline]] static bool all(const Bits& a) noexcept {
#ifdef __AVX__
    if constexpr (W == 4) return _mm256_movemask_pd((__m256d)a) == 0xf;
#endif
    std::uint64_t both = a[0];
    for (int i = 1; i < W; ++i) both &= a[i];
    return both != 0;
  }
  [[gnu::always_inline]] static bool at(const Bits& a, int i) noexcept {
    return a[i] != 0;
  }
  [[gnu::always_inline]] static Register root(const Register& a) noexcept {
#ifdef __AVX__
    if constexpr (W == 4) return (Register)_mm256_sqrt_pd((__m256d)a);
#endif
    Register b;
    for (int i = 0; i < W; ++i) b[i] = std::sqrt(a[i]);
    return b;
  }
};

#ifdef __AVX512F__
template <>
struct Truths<8> {  // a bit of each
  using Register = Registers<8>::Register;
  using Bits = __mmask8;

  [[gnu::always_inline]] static Bits less(const Register& a, const Register& b) noexcept {
    return _mm512_cmp_pd_mask((__m512d)a, (__m512d)b, _CMP_LT_OQ);
  }
  [[gnu::always_inline]] static Bits at_most(const Register& a, const Register& b) noexcept {
    return _mm512_cmp_pd_mask((__m512d)a, (__m512d)b, _CMP_LE_OQ);
  }
  [[gnu::always_inline]] static Bits equal(const Register& a, const Register& b) noexcept {
    return _mm512_cmp_pd_mask((__m512d)a, (__m512d)b, _CMP_EQ_OQ);
  }
  [[gnu::always_inline]] static Bits no(const Bits& a) noexcept { return static_cast<Bits>(~a); }
  [[gnu::always_inline]] static Register choose(const Bits& is, const Register& a,
                                                const Register& b) noexcept {
    return (Register)_mm512_mask_blend_pd(is, (__m512d)b, (__m512d)a);
  }
  [[gnu::always_inline]] static bool all(const Bits& a) noexcept { return a == 0xff; }
  [[gnu::always_inline]] static bool at(const Bits& a, int i) noexcept { return a >> i & 1; }
  [[gnu::always_inline]] static Register root(const Register& a) noexcept {
    return (Register)_mm512_maskz_sqrt_pd(0xff, (__m512d)a);
  }
};
#endif

}  // namespace tauext::detail
