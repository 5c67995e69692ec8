#include "algorithms/factors/link_order.h"

#include <algorithm>

namespace delassus {

LinkOrder::LinkOrder(const Structure& s, const Plan& plan) : first_(1, 0) {
  std::size_t count = 0;
  for (const auto& e : s.link_constraints) count += e.links.size();
  links_.reserve(count);
  first_.reserve(s.link_constraints.size() + 1);
  for (const auto& e : s.link_constraints) {
    const int first = first_.back();
    for (const auto& link : e.links) links_.push_back({plan.step[link.body], static_cast<int>(links_.size()) - first});
    const auto earlier = [](const Link& a, const Link& b) { return a.step < b.step; };
    if (e.links.size() == 2 && earlier(links_.back(), links_[first])) std::swap(links_[first], links_.back());
    if (e.links.size() > 2) std::sort(links_.begin() + first, links_.end(), earlier);
    first_.push_back(static_cast<int>(links_.size()));
  }
  order(plan.steps);
}

bool LinkOrder::same_bodies(int a, int b) const {
  return std::ranges::equal(links(a), links(b), [](const Link& x, const Link& y) { return x.step == y.step; });
}

// By counting those of each first step, then each of these by comparison.
void LinkOrder::order(int steps) {
  const int count = static_cast<int>(first_.size()) - 1;
  const auto key = [this](int e) { return links(e).empty() ? 0 : links(e).front().step; };
  const auto before = [this](int a, int b) {
    return std::ranges::lexicographical_compare(links(a), links(b), [](const Link& x, const Link& y) { return x.step < y.step; });
  };
  std::vector<int> at(static_cast<std::size_t>(steps) + 1, 0);
  for (int e = 0; e < count; ++e) ++at[key(e) + 1];
  for (int i = 0; i < steps; ++i) at[i + 1] += at[i];
  order_.resize(static_cast<std::size_t>(count));
  for (int e = 0; e < count; ++e) order_[at[key(e)]++] = e;
  for (int i = 0, begin = 0; i < steps; begin = at[i++])
    if (const auto from = order_.begin() + begin, to = order_.begin() + at[i]; !std::is_sorted(from, to, before))
      std::stable_sort(from, to, before);
}

}  // namespace delassus
