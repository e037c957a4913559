// SPDX-License-Identifier: Apache-2.0
/// @file
/// Counts heap allocations, also those that bypass operator new: a program that scores entries gets
/// a malloc that counts and then calls glibc's.
#pragma once

#include <cstdint>
#ifdef EIGEN_RUNTIME_NO_MALLOC
#include <Eigen/Core>
#endif

namespace tauext {

/// Allocations of this thread so far.
std::uint64_t allocations() noexcept;

/// False under sanitizers, which bring their own malloc: then allocations() stays 0.
bool allocations_are_counted() noexcept;

/// Heap allocations of a call; with EIGEN_RUNTIME_NO_MALLOC Eigen's own ones abort.
template <class Call>
std::uint64_t allocations_of(Call&& call) {
#ifdef EIGEN_RUNTIME_NO_MALLOC
  Eigen::internal::set_is_malloc_allowed(false);
#endif
  const auto before = allocations();
  call();
  const auto after = allocations();
#ifdef EIGEN_RUNTIME_NO_MALLOC
  Eigen::internal::set_is_malloc_allowed(true);
#endif
  return after - before;
}

}  // namespace tauext
