// Memory of a program that counts its instructions: one stretch, handed out in order, at cache lines, never taken back. Compilers
// check where arrays lie – aligned, apart, one before the other – and take another path by it; here the answers are those of the
// order of allocation, and the same steps have the same instructions in every run. Not under sanitizers, which have their own.
#if defined(__linux__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)

#include <sys/mman.h>

#include <atomic>
#include <cerrno>
#include <cstdlib>
#include <cstring>

namespace {

constexpr std::size_t line = 64, all = std::size_t{1} << 36;  // of addresses; memory is what is touched
std::atomic<std::size_t> used{0};

char* stretch() {
  static char* const begin = static_cast<char*>(mmap(nullptr, all, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0));
  return begin;
}

/// A line before what is handed out has its size.
void* take(std::size_t bytes, std::size_t alignment) {
  const std::size_t room = (bytes + line - 1) / line * line + line + (alignment > line ? alignment : 0);
  const std::size_t at = used.fetch_add(room);
  if (stretch() == MAP_FAILED || bytes > all || at + room > all) return errno = ENOMEM, nullptr;
  auto place = reinterpret_cast<std::size_t>(stretch() + at + line);
  if (alignment > line) place = (place + alignment - 1) / alignment * alignment;
  auto* const out = reinterpret_cast<char*>(place);
  std::memcpy(out - sizeof bytes, &bytes, sizeof bytes);
  return out;
}

}  // namespace

extern "C" {
void* malloc(std::size_t bytes) { return take(bytes, line); }
void free(void*) {}
void* calloc(std::size_t n, std::size_t bytes) { return take(n * bytes, line); }  // untouched memory is zero
void* realloc(void* old, std::size_t bytes) {
  void* const out = take(bytes, line);
  std::size_t had = 0;
  if (old != nullptr) std::memcpy(&had, static_cast<char*>(old) - sizeof had, sizeof had);
  return out != nullptr && had > 0 ? std::memcpy(out, old, had < bytes ? had : bytes) : out;
}
void* memalign(std::size_t alignment, std::size_t bytes) { return take(bytes, alignment); }
void* aligned_alloc(std::size_t alignment, std::size_t bytes) { return take(bytes, alignment); }
int posix_memalign(void** out, std::size_t alignment, std::size_t bytes) { return (*out = take(bytes, alignment)) == nullptr ? ENOMEM : 0; }
}

#endif
