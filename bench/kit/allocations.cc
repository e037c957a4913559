// SPDX-License-Identifier: Apache-2.0
#include "bench/kit/allocations.h"

#include <cerrno>
#include <cstddef>

#if defined(TAUEXT_SANITIZED) || !defined(__GLIBC__)
#define TAUEXT_COUNTS 0
#else
#define TAUEXT_COUNTS 1
#endif

namespace {
// constinit and without a destructor: malloc runs before and after everything else
thread_local constinit std::uint64_t count = 0;
}  // namespace

namespace tauext {
std::uint64_t allocations() noexcept {
  return count;
}
bool allocations_are_counted() noexcept {
  return TAUEXT_COUNTS;
}
}  // namespace tauext

#if TAUEXT_COUNTS
extern "C" {

// glibc's own, under the names it keeps for replacements of malloc
void* __libc_malloc(std::size_t);
void* __libc_calloc(std::size_t, std::size_t);
void* __libc_realloc(void*, std::size_t);
void* __libc_memalign(std::size_t, std::size_t);

void* malloc(std::size_t n) {
  return ++count, __libc_malloc(n);
}
void* calloc(std::size_t n, std::size_t size) {
  return ++count, __libc_calloc(n, size);
}
void* realloc(void* p, std::size_t n) {
  return ++count, __libc_realloc(p, n);
}
void* memalign(std::size_t align, std::size_t n) {
  return ++count, __libc_memalign(align, n);
}
void* aligned_alloc(std::size_t align, std::size_t n) {
  return ++count, __libc_memalign(align, n);
}
int posix_memalign(void** p, std::size_t align, std::size_t n) {
  ++count;
  void* const got = __libc_memalign(align, n);
  if (got == nullptr) return ENOMEM;
  *p = got;
  return 0;
}

}  // extern "C"
#endif
