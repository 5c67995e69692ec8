#include "algorithms/factors/link_order.h"

#include <algorithm>

namespace delassus {

LinkOrder::LinkOrder(const Structure& s, const Plan& plan) {
  const std::size_t constraints = s.link_constraints.size();
  std::size_t count = 0;
  for (const auto& e : s.link_constraints) count += e.links.size();
  lists_.divide(Lists::Part{links_, count}, Lists::Part{first_, constraints + 1}, Lists::Part{order_, constraints},
                Lists::Part{at_, static_cast<std::size_t>(plan.steps) + 1}, Lists::Part{as_before_, constraints});
  int next = 0, constraint = 0;
  for (const auto& e : s.link_constraints) {
    Link* const first = links_.data() + next;
    int place = 0;
    for (const auto& link : e.links) links_[next++] = {plan.step[link.body], place++};
    const auto earlier = [](const Link& a, const Link& b) { return a.step < b.step; };
    if (place == 2 && earlier(first[1], first[0])) std::swap(first[0], first[1]);
    if (place > 2) std::sort(first, first + place, earlier);
    first_[++constraint] = next;
  }
  order(plan.steps);
}

// By counting those of each first step, then each of these by comparison.
void LinkOrder::order(int steps) {
  const int count = size();
  const auto key = [this](int e) { return links(e).empty() ? 0 : links(e).front().step; };
  const auto before = [this](int a, int b) {
    return std::ranges::lexicographical_compare(links(a), links(b), [](const Link& x, const Link& y) { return x.step < y.step; });
  };
  for (int e = 0; e < count; ++e) ++at_[key(e) + 1];
  for (int i = 0; i < steps; ++i) at_[i + 1] += at_[i];
  for (int e = 0; e < count; ++e) order_[at_[key(e)]++] = e;
  const auto stable = [&](int a, int b) { return before(a, b) || (a < b && !before(b, a)); };  // std::stable_sort allocates
  for (int i = 0, begin = 0; i < steps; begin = at_[i++])
    if (const auto from = order_.begin() + begin, to = order_.begin() + at_[i]; !std::is_sorted(from, to, before)) std::sort(from, to, stable);
  for (int k = 1; k < count; ++k)
    as_before_[k] = std::ranges::equal(links(order_[k]), links(order_[k - 1]), [](const Link& x, const Link& y) { return x.step == y.step; });
}

}  // namespace delassus
