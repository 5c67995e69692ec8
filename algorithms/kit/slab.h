// One array for many: what belongs together stands in one piece of memory, and its size is known.
#pragma once

#include <cstddef>
#include <initializer_list>
#include <memory>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include "algorithms/kit/spatial.h"

namespace delassus {

template <class E> class Slab {
 public:
  Slab() = default;
  Slab(const Slab&) = delete;  // its spans would stay with the original
  Slab& operator=(const Slab&) = delete;

  /// Gives each span its number of entries, one behind the other, all of them `zero`.
  void divide(const E& zero, std::initializer_list<std::pair<std::span<E>*, std::size_t>> parts) {
    std::size_t total = 0;
    for (const auto& part : parts) total += part.second;
    entries_.assign(total, zero);
    E* next = entries_.data();
    for (const auto& [span, count] : parts) {
      *span = {next, count};
      next += count;
    }
  }
  [[nodiscard]] Index bytes() const { return static_cast<Index>(entries_.size() * sizeof(E)); }

 private:
  std::vector<E> entries_;
};

/// The same for several types that are nothing but their bytes, all of them zero. Spans stay good when this moves.
class Lists {
 public:
  template <class E> struct Part {
    std::span<E>& list;
    std::size_t count;
  };
  template <class E> Part(std::span<E>&, std::size_t) -> Part<E>;

  template <class... E> void divide(Part<E>... parts) {
    static_assert((... && (std::is_trivially_copyable_v<E> && alignof(E) <= step)));
    bytes_ = (std::size_t{0} + ... + room<E>(parts.count));
    memory_.reset(new std::byte[bytes_]());
    std::byte* next = memory_.get();
    ((parts.list = {reinterpret_cast<E*>(next), parts.count}, next += room<E>(parts.count)), ...);
  }
  [[nodiscard]] Index bytes() const { return static_cast<Index>(bytes_); }

 private:
  static constexpr std::size_t step = 8;
  template <class E> static constexpr std::size_t room(std::size_t count) { return (count * sizeof(E) + step - 1) / step * step; }

  std::unique_ptr<std::byte[]> memory_;
  std::size_t bytes_ = 0;
};

}  // namespace delassus
