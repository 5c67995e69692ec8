// One array for many: what belongs together stands in one piece of memory, and its size is known.
#pragma once

#include <initializer_list>
#include <span>
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

}  // namespace delassus
