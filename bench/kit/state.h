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
template <class T>
int copy_state(const T& object, int most, void* bytes) noexcept {
  // what no copy writes holds what lay there before: on two grounds it differs, and is left out
  alignas(T) unsigned char copies[2][sizeof(T)];
  for (auto& copy : copies) {
    std::memset(copy, &copy == copies ? 0 : 255, sizeof copy);
    keep(copy);  // else the compiler knows that constructors and destructors end it
    std::destroy_at(new (copy) T(object)), keep(copy);
  }
  // and so is what pads it, which a copy may take along
  T plain(object);
#if __has_builtin(__builtin_clear_padding)
  __builtin_clear_padding(&plain);
#endif
  const auto* const value = reinterpret_cast<const unsigned char*>(&plain);
  auto* const out = static_cast<unsigned char*>(bytes);
  for (int i = 0; i < std::min<int>(most, sizeof(T)); ++i)
    out[i] = copies[0][i] == copies[1][i] ? value[i] : 0;
  return static_cast<int>(sizeof(T));
}

}  // namespace tauext::detail
