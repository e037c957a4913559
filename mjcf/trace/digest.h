// SPDX-License-Identifier: Apache-2.0
/// @file
/// A number that tells texts apart, the same on every machine; none against people of ill will.
#pragma once

#include <cstdint>
#include <string_view>

namespace tauext {

/// FNV-1a of Fowler, Noll and Vo, 64 bits.
constexpr std::uint64_t fnv1a(std::string_view text) noexcept {
  std::uint64_t hash = 0xcbf29ce484222325;
  for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3;
  return hash;
}
// as draft-eastlake-fnv prints it
static_assert(fnv1a("foobar") == 0x85944171f73967e8);

}  // namespace tauext
