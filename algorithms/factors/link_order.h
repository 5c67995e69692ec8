// The link constraints of a structure in the order a plan eliminates their bodies: those on the same bodies come together.
// Cost: O(links), and a sort among those with the same first body that are not in order already.
#pragma once

#include <span>

#include "algorithms/factors/plan.h"

namespace delassus {

class LinkOrder {
 public:
  struct Link {
    int step, place;  ///< place in its constraint
  };

  LinkOrder(const Structure& structure, const Plan& plan);
  [[nodiscard]] int size() const { return static_cast<int>(order_.size()); }
  /// The k-th constraint.
  [[nodiscard]] int operator[](int k) const { return order_[k]; }
  /// The k-th constraint is on the bodies of the one before it.
  [[nodiscard]] bool as_before(int k) const { return as_before_[k] != 0; }
  /// Of a constraint, by steps.
  [[nodiscard]] std::span<const Link> links(int constraint) const {
    return {links_.data() + first_[constraint], static_cast<std::size_t>(first_[constraint + 1] - first_[constraint])};
  }

 private:
  void order(int steps);

  Lists lists_;
  std::span<Link> links_;
  std::span<int> first_, order_, at_;
  std::span<char> as_before_;
};

}  // namespace delassus
