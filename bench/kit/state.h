// SPDX-License-Identifier: Apache-2.0
/// @file
/// The bytes of an object that mean something, so that two can be compared.
#pragma once

#include <algorithm>
#include <cstring>
#include <memory>
#include <new>

namespace tauext::detail {

// the compiler has to compute x and may not know what it is used for
template <class T>
[[gnu::always_inline]] inline void keep(const T& x) {
  asm volatile("" : : "r"(&x) : "memory");
}

/// Writes at most so many bytes of it, and gives their number; 0 stands for those of no member.
/// Gives 0 for an object that owns memory elsewhere, of which these bytes say nothing.
template <class T>
int copy_state(const T& object, int most, void* bytes) noexcept {
  // what no copy writes holds what lay there before, which is 0 in one copy and 255 in the other
  alignas(T) unsigned char copies[2][sizeof(T)];
  T* made[2];
  for (int i : {0, 1}) {
    std::memset(copies[i], i == 0 ? 0 : 255, sizeof(T));
    keep(copies[i]);  // else the compiler leaves that out, as a constructor follows,
    made[i] = new (copies[i]) T(object);
    keep(*made[i]);  // and what the constructor writes, as nobody reads it as a T
  }
  // what pads it is left out, too: a copy may take it along
  T plain(object);
#if __has_builtin(__builtin_clear_padding)
  __builtin_clear_padding(&plain);
#endif
  const auto* const value = reinterpret_cast<const unsigned char*>(&plain);
  auto* const out = static_cast<unsigned char*>(bytes);
  bool known = true;
  for (int i = 0; i < static_cast<int>(sizeof(T)); ++i) {
    const bool same = copies[0][i] == copies[1][i];
    // two copies differ in what they write where each holds an address of its own
    known = known && (same || (copies[0][i] == 0 && copies[1][i] == 255));
    if (i < most) out[i] = same ? value[i] : 0;
  }
  for (T* copy : made) std::destroy_at(copy);
  return known ? static_cast<int>(sizeof(T)) : 0;
}

}  // namespace tauext::detail
