#include "algorithms/factors/link_rows.h"

#include <algorithm>
#include <utility>

#include "algorithms/factors/link_order.h"
#include "algorithms/kit/instantiate.h"

namespace delassus {
namespace {

// Where the pair of places a, b stands among (0,1) (0,2) … (1,2) … of n.
int place_of_pair(int a, int b, int n) {
  if (a > b) std::swap(a, b);
  return a * (2 * n - a - 1) / 2 + b - a - 1;
}

// What analyze will append; of sources the most.
struct Counts {
  std::size_t groups = 0, bodies = 0, pairs = 0, spans = 0, segments = 0, links = 0;
};
Counts counted(const Structure& s, const LinkOrder& sorted) {
  Counts all;
  for (int k = 0; k < sorted.size(); ++k) {
    const std::size_t n = sorted.links(sorted[k]).size();
    const bool same = sorted.as_before(k);
    const auto& e = s.link_constraints;
    const bool adjacent = same && e[sorted[k - 1]].row + e[sorted[k - 1]].rows == e[sorted[k]].row;
    if (!same) ++all.groups, all.bodies += n, all.pairs += n * (n - (n > 0)) / 2;
    if (!adjacent) ++all.spans, all.segments += n;
    all.links += n;
  }
  return all;
}

// A list that is being written.
template <class E> struct Appended {
  std::span<E>& list;
  int count = 0;
  void push_back(const E& e) { list[count++] = e; }
  E& back() { return list[count - 1]; }
  [[nodiscard]] int size() const { return count; }
  void end() { list = list.first(static_cast<std::size_t>(count)); }
};
template <class E> Appended(std::span<E>&) -> Appended<E>;

}  // namespace

template <class T> void LinkRows<T>::analyze(const Structure& s, const Plan& plan) {
  const LinkOrder sorted(s, plan);
  const Counts all = counted(s, sorted);
  const bool coupled = plan.matrix == Matrix::M_R;
  std::span<char> seen;
  lists_.divide(Lists::Part{groups_, all.groups + 1}, Lists::Part{bodies_, all.bodies}, Lists::Part{pairs_, coupled ? all.pairs : 0},
                Lists::Part{constraints_, static_cast<std::size_t>(sorted.size())}, Lists::Part{segments_, all.segments},
                Lists::Part{spans_, all.spans}, Lists::Part{sources_, all.links}, Lists::Part{seen, static_cast<std::size_t>(plan.active())});
  Appended groups{groups_};
  Appended spans{spans_};
  Appended sources{sources_};
  Appended segments{segments_};
  Appended constraints{constraints_};
  Appended bodies{bodies_};
  Appended pairs{pairs_};
  int first = 0, largest = 0;
  for (int begin = 0, end = 0; begin < sorted.size(); begin = end) {
    const auto links = sorted.links(sorted[begin]);
    Group group{bodies.size(), pairs.size(), constraints.size(), 0, first};
    const int n = static_cast<int>(links.size()), first_span = spans.size();
    for (end = begin; end < sorted.size() && (end == begin || sorted.as_before(end)); ++end) {
      const auto& e = s.link_constraints[sorted[end]];
      const int row = static_cast<int>(e.row), rows = static_cast<int>(e.rows);
      if (end > begin && spans.back().row + spans.back().rows == row) spans.back().rows += rows;
      else spans.push_back({group.first_body, n, row, rows, first + group.rows, 0});
      constraints.push_back({sorted[end], row, rows});
      group.rows += rows;
    }
    for (int b = 0; b < n; ++b) {
      const int step = links[b].step - plan.first_active;
      bodies.push_back({step, std::exchange(seen[step], 1) != 0});
      for (int k = begin; k < end; ++k) {
        const auto& e = s.link_constraints[sorted[k]];
        const int from = static_cast<int>(e.links[sorted.links(sorted[k])[b].place].first), rows = static_cast<int>(e.rows);
        if (sources.size() > 0 && sources.back().from + sources.back().rows == from) sources.back().rows += rows;
        else sources.push_back({from, first, rows});
        first += rows;
      }
    }
    for (int span = first_span; span < spans.size(); ++span) spans_[span].stride = group.rows;
    for (int b = 0; b < n; ++b)
      for (int span = first_span; span < spans.size(); ++span) segments.push_back({bodies_[group.first_body + b].step, spans_[span].row, spans_[span].rows});
    if (coupled)
      for (int a = 0; a < n; ++a)
        for (int b = a + 1; b < n; ++b)
          pairs.push_back(plan.constraint_pairs[plan.first_constraint_pair[sorted[begin]] + place_of_pair(links[a].place, links[b].place, n)]);
    groups.push_back(group);
    largest = std::max(largest, first - group.first);
  }
  groups.push_back({bodies.size(), pairs.size(), constraints.size(), 0, first});
  sources.end();
  // gather reads four at a time
  sixes_.divide(Six<T>::zero(), {{&k_, static_cast<std::size_t>(first + 3)}, {&weighted_, static_cast<std::size_t>(coupled ? largest : 0)}});
}

template <class T> void LinkRows<T>::load(const Problem<T>& problem) {
  for (const Source& s : sources_)
    for (int r = 0; r < s.rows; ++r) k_[s.to + r] = delassus::load(problem.K[s.from + r]);
}

// H_ii += K_iᵀ R K_i of body b of a group; R K_i is kept
template <class T>
void LinkRows<T>::add_inertia(const Group& g, int b, const BlockDiagonal<T>& weights, const SixBySix<T>& from, SixBySix<T>& to) {
  const Six<T>* k = k_.data() + g.first + b * g.rows;
  Six<T>* weighted = weighted_.data() + b * g.rows;
  SixBySix<T> sum = copied(from);
  for (int e = g.first_constraint; e < (&g + 1)->first_constraint; ++e) {
    const auto [constraint, row, m] = constraints_[e];
    const T* const R = weights.dense(constraint);
    for (int r = 0; r < m; ++r, ++weighted) {
      if (R == nullptr) *weighted = scaled(k[r], weights.diagonal(row + r));
      else {
        *weighted = Six<T>::zero();
        for (int q = 0; q < m; ++q) add_scaled(*weighted, k[q], R[q * m + r]);
      }
      add_outer(sum, *weighted, k[r]);
    }
    k += m;
  }
  copy(sum, to);
}

// Alg. 4, lines 2–11: H_ii += K_iᵀ R K_i; H_ij += K_jᵀ R K_i, i the earlier one
template <class T>
void LinkRows<T>::add_weights(const BlockDiagonal<T>& weights, const SixBySix<T>* own, SixBySix<T>* inertia, SixBySix<T>* block) {
  const int* pair = pairs_.data();
  for (auto g = groups_.begin(); g + 1 < groups_.end(); ++g) {
    const int bodies = g[1].first_body - g->first_body;
    for (int b = 0; b < bodies; ++b) {
      const int i = bodies_[g->first_body + b].step;
      add_inertia(*g, b, weights, bodies_[g->first_body + b].again ? inertia[i] : own[i], inertia[i]);
    }
    for (int a = 0; a < bodies; ++a)
      for (int b = a + 1; b < bodies; ++b)
        add_products(block[*pair++], weighted_.data() + b * g->rows, k_.data() + g->first + a * g->rows, g->rows);
  }
}

// f_i += Σ K_e^iᵀ x_e
template <class T> template <class V> void LinkRows<T>::scatter(const V* x, Six<V>* f) const {
  const Six<T>* k = k_.data();
  for (const Segment& s : segments_) {
    Six<V> sum = f[s.step];
    for (int r = 0; r < s.rows; ++r) add_scaled(sum, *k++, x[s.row + r]);
    f[s.step] = sum;
  }
}

// y_e = Σ K_e^i a_i
template <class T> template <class V> void LinkRows<T>::gather(const Six<V>* a, V* y) const {
  for (const Span& s : spans_) {
    const Six<T>* k = k_.data() + s.first;
    const Body* const bodies = bodies_.data() + s.first_body;
    if (s.bodies == 0) std::fill_n(y + s.row, s.rows, V{});
    else if constexpr (has_lanes<V> && sums_together) {
      for (int r = 0; r < s.rows; r += 4, k += 4) {  // four sums at once
        Six<V> p[4];
        for (int q = 0; q < 4; ++q) p[q] = product(k[q], a[bodies[0].step]);
        for (int b = 1; b < s.bodies; ++b)
          for (int q = 0; q < 4; ++q) add_product(p[q], k[b * s.stride + q], a[bodies[b].step]);
        store_lanes(y + s.row + r, four_sums(p), s.rows - r);
      }
    } else {
      for (int r = 0; r < s.rows; ++r, ++k) {
        y[s.row + r] = dot(*k, a[bodies[0].step]);
        for (int b = 1; b < s.bodies; ++b) y[s.row + r] += dot(k[b * s.stride], a[bodies[b].step]);
      }
    }
  }
}

template <class T> void LinkRows<T>::mobility(const SixBySix<T>* omega, T* d) const {
  for (const Span& s : spans_)
    for (int r = 0; r < s.rows; ++r) {
      d[s.row + r] = T(0);
      for (int b = 0; b < s.bodies; ++b) {
        const Six<T>& k = k_[s.first + b * s.stride + r];
        d[s.row + r] += T(s.bodies) * dot(k, multiply(omega[bodies_[s.first_body + b].step], k));
      }
    }
}

#define DELASSUS_INSTANTIATE(T) template class LinkRows<T>; template void LinkRows<T>::scatter<T>(const T*, Six<T>*) const; \
  template void LinkRows<T>::gather<T>(const Six<T>*, T*) const;
DELASSUS_FOR_EACH_SCALAR(DELASSUS_INSTANTIATE)
#ifdef DELASSUS_EXACT
DELASSUS_INSTANTIATE(Stochastic)
#else
template void LinkRows<double>::scatter<Lanes8>(const Lanes8*, Six<Lanes8>*) const;
template void LinkRows<double>::gather<Lanes8>(const Six<Lanes8>*, Lanes8*) const;
template void LinkRows<float>::scatter<Lanes8f>(const Lanes8f*, Six<Lanes8f>*) const;
template void LinkRows<float>::gather<Lanes8f>(const Six<Lanes8f>*, Lanes8f*) const;
#endif

}  // namespace delassus
