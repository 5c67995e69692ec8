// The link constraints of a structure in the order a plan eliminates their bodies: those on the same bodies come together.
// Cost: O(links), and a sort among those with the same first body that are not in order already.
#pragma once

#include <span>
#include <vector>

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
  /// Of a constraint, by steps.
  [[nodiscard]] std::span<const Link> links(int constraint) const {
    return {links_.data() + first_[constraint], static_cast<std::size_t>(first_[constraint + 1] - first_[constraint])};
  }
  [[nodiscard]] bool same_bodies(int constraint, int other) const;

 private:
  void order(int steps);

  std::vector<Link> links_;
  std::vector<int> first_, order_;
};

}  // namespace delassus
