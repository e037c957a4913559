// SPDX-License-Identifier: Apache-2.0
/// @file
/// Counts heap allocations, also those that bypass operator new: a program that scores entries gets
/// a malloc that counts and then calls glibc's.
#pragma once

#include <cstdint>

namespace tauext {

/// Allocations of this thread so far.
std::uint64_t allocations() noexcept;

/// False under sanitizers, which bring their own malloc: then allocations() stays 0.
bool allocations_are_counted() noexcept;

}  // namespace tauext
