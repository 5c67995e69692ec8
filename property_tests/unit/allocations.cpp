#include "property_tests/unit/allocations.h"

#include <cerrno>
#include <cstddef>

#include "property_tests/laws/laws.h"

#if defined(__SANITIZE_ADDRESS__)
#define DELASSUS_SANITIZED 1
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)
#define DELASSUS_SANITIZED 1
#endif
#endif

#if defined(__GLIBC__) && !defined(DELASSUS_SANITIZED)

namespace {
constinit thread_local std::int64_t allocations = 0;
}

// operator new and Eigen's aligned allocation both end in one of these.
extern "C" {
void* __libc_malloc(std::size_t);
void* __libc_calloc(std::size_t, std::size_t);
void* __libc_realloc(void*, std::size_t);
void* __libc_memalign(std::size_t, std::size_t);

void* malloc(std::size_t n) {
  ++allocations;
  return __libc_malloc(n);
}
void* calloc(std::size_t n, std::size_t size) {
  ++allocations;
  return __libc_calloc(n, size);
}
void* realloc(void* p, std::size_t n) {
  ++allocations;
  return __libc_realloc(p, n);
}
void* aligned_alloc(std::size_t alignment, std::size_t n) {
  ++allocations;
  return __libc_memalign(alignment, n);
}
int posix_memalign(void** p, std::size_t alignment, std::size_t n) {
  ++allocations;
  *p = __libc_memalign(alignment, n);
  return *p ? 0 : ENOMEM;
}
}

void delassus::laws::count_allocations() {
  allocation_count = [] { return allocations; };
}

#else

void delassus::laws::count_allocations() {}

#endif
