#include "algorithms/operators/efpa.h"

#include <algorithm>

#include "algorithms/kit/instantiate.h"

namespace delassus {

template <class T> void Efpa<T>::analyze_pairs() {
  const Plan& plan = this->plan_;
  meeting_.assign(static_cast<std::size_t>(plan.active()), 0);
  for (int j = 0; j < this->sites(); ++j) meeting_[this->active(this->sites_[j].step)] = 1;
  std::vector<int> children(meeting_.size(), 0);
  for (int i = plan.first_active; i < plan.steps; ++i) {
    if (this->has_joint_rows(i)) meeting_[this->active(i)] = 1;
    if (plan.parent[i] >= 0 && ++children[this->active(plan.parent[i])] == 2) meeting_[this->active(plan.parent[i])] = 1;
  }
  first_propagator_.clear(), at_.clear(), first_pair_.clear(), pairs_.clear();
  int most = 0;
  for (int j = 0; j < this->sites(); ++j) {
    first_propagator_.push_back(static_cast<int>(at_.size()));
    for (int l = this->sites_[j].step; l >= 0; l = plan.parent[l])
      if (meeting_[this->active(l)]) at_.push_back(l);
    most = std::max(most, static_cast<int>(at_.size()) - first_propagator_.back());
  }
  first_propagator_.push_back(static_cast<int>(at_.size()));
  for (int j = 0; j < this->sites(); ++j) {
    first_pair_.push_back(static_cast<int>(pairs_.size()));
    for (int i = 0; i < j; ++i) {
      if (!this->same_tree(this->sites_[i].step, this->sites_[j].step)) continue;
      Pair pair{i, 0, 0};  // both lists ascend, and are one from l on
      const int *const of_i = at_.data() + first_propagator_[i], *const of_j = at_.data() + first_propagator_[j];
      while (of_i[pair.of_site] != of_j[pair.of_other]) ++(of_i[pair.of_site] < of_j[pair.of_other] ? pair.of_site : pair.of_other);
      pairs_.push_back(pair);
    }
  }
  first_pair_.push_back(static_cast<int>(pairs_.size()));
  propagators_.assign(at_.size(), SixBySix<T>::zero());
  pushed_.assign(static_cast<std::size_t>(most), SixBySix<T>::zero());
}

// P_{j→l} of a site, and Z
template <class T> void Efpa<T>::propagate(int site) {
  SixBySix<T> P;
  for (int c = 0; c < 6; ++c) P.column[c] = unit_vector<T>(c);
  int b = this->sites_[site].step;
  for (int k = first_propagator_[site]; k < first_propagator_[site + 1]; ++k) {
    for (; b != at_[k]; b = this->plan_.parent[b]) {
      const auto joint = this->factor_M_.joint(b);
      for (int c = 0; c < 6; ++c) carry_inwards(joint, P.column[c]);
    }
    copy(P, propagators_[k]);
    SixBySix<T>& Z = pushed_[k - first_propagator_[site]];
    for (int c = 0; c < 6; ++c) Z.column[c] = multiply(this->omega_[this->active(b)], P.column[c]);
  }
}

template <class T> void Efpa<T>::add_bodies(int site) {
  for (int k = first_pair_[site]; k < first_pair_[site + 1]; ++k) {
    const Pair& pair = pairs_[k];
    const SixBySix<T> out = transposed(propagators_[first_propagator_[pair.site] + pair.of_site]);
    SixBySix<T> omega;
    for (int c = 0; c < 6; ++c) omega.column[c] = multiply(out, pushed_[pair.of_other].column[c]);
    this->add_motions(pair.site, omega, site);
  }
}

// Pᵀ S D⁻¹𝒦ᵀ of the rows on every joint between a site and the root
template <class T> void Efpa<T>::add_joints_of(int site) {
  for (int k = first_propagator_[site]; k < first_propagator_[site + 1]; ++k) {
    if (!this->has_joint_rows(at_[k])) continue;
    const auto joint = this->factor_M_.joint(at_[k]);
    const SixBySix<T> out = transposed(propagators_[k]);
    this->factor_M_.for_joint_rows(at_[k], [&](int row, const T* of_row) { this->add_motion(site, multiply(out, this->motion_of(joint, of_row)), row); });
  }
}

template <class T> void Efpa<T>::add_pairs() {
  for (int j = 0; j < this->sites(); ++j) {
    propagate(j);
    add_bodies(j);
    add_joints_of(j);
  }
}

template <class T> Index Efpa<T>::pair_bytes() const {
  return static_cast<Index>(meeting_.size() + (first_propagator_.size() + at_.size() + first_pair_.size()) * sizeof(int) + pairs_.size() * sizeof(Pair) +
                            (propagators_.size() + pushed_.size()) * sizeof(SixBySix<T>));
}

#define DELASSUS_INSTANTIATE(T) template class Efpa<T>;
DELASSUS_FOR_EACH_SCALAR(DELASSUS_INSTANTIATE)

}  // namespace delassus
