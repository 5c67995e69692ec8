#include "algorithms/operators/efp.h"

#include <algorithm>

#include "algorithms/kit/instantiate.h"

namespace delassus {

template <class T> void Efp<T>::analyze_pairs() {
  const Plan& plan = this->plan_;
  trees_.clear(), steps_.clear(), sites_of_.clear();
  for (int root = plan.first_active; root < plan.steps; ++root) {
    if (plan.parent[root] >= 0) continue;
    trees_.push_back({root, static_cast<int>(steps_.size()), static_cast<int>(sites_of_.size())});
  }
  trees_.push_back({-1, 0, 0});
  std::vector<int> tree_of(static_cast<std::size_t>(plan.active()), 0);
  for (int t = 0; t + 1 < static_cast<int>(trees_.size()); ++t) tree_of[this->active(trees_[t].root)] = t;
  for (int i = plan.first_active; i < plan.steps; ++i) tree_of[this->active(i)] = tree_of[this->active(this->tree_[this->active(i)])];
  steps_.resize(static_cast<std::size_t>(plan.active()));
  for (int k = 0; k < plan.active(); ++k) steps_[k] = plan.steps - 1 - k;
  sites_of_.resize(static_cast<std::size_t>(this->sites()));
  for (int k = 0; k < this->sites(); ++k) sites_of_[k] = k;
  const auto of_step = [&](int step) { return tree_of[this->active(step)]; };
  std::stable_sort(steps_.begin(), steps_.end(), [&](int a, int b) { return of_step(a) < of_step(b); });
  std::stable_sort(sites_of_.begin(), sites_of_.end(), [&](int a, int b) { return of_step(this->sites_[a].step) < of_step(this->sites_[b].step); });
  for (std::size_t k = steps_.size(); k-- > 0;) trees_[of_step(steps_[k])].first_step = static_cast<int>(k);
  trees_.back().first_step = static_cast<int>(steps_.size());
  int site = 0;  // a tree may have none
  for (int t = 0; t < static_cast<int>(trees_.size()); ++t) {
    trees_[t].first_site = site;
    while (site < this->sites() && of_step(this->sites_[sites_of_[site]].step) == t) ++site;
  }
  on_path_.assign(static_cast<std::size_t>(plan.active()), 0);
  force_.assign(on_path_.size(), Six<T>::zero());
  motion_ = force_;
}

template <class T>
void Efp<T>::add_row(const OfTree& tree, int row, int start, Six<T> kappa, int joint, const Six<T>& push, int end) {
  const auto& parent = this->plan_.parent;
  ++count_;
  for (int b = start; b >= 0; b = parent[b]) {
    on_path_[this->active(b)] = count_;
    force_[this->active(b)] = kappa;
    if (parent[b] >= 0) carry_inwards(this->factor_M_.joint(b), kappa);
  }
  for (int k = tree.first_step; k < (&tree + 1)->first_step; ++k) {
    const int b = steps_[k], at = this->active(b);
    Six<T>& motion = motion_[at];
    if (on_path_[at] == count_) {
      motion = multiply(this->omega_[at], force_[at]);
      continue;
    }
    motion = parent[b] < 0 ? Six<T>::zero() : motion_[this->active(parent[b])];
    if (parent[b] >= 0) carry_outwards(this->factor_M_.joint(b), motion);
    if (b == joint) add(motion, push);
  }
  for (int k = tree.first_site; k < (&tree + 1)->first_site && sites_of_[k] < end; ++k)
    this->add_motion(sites_of_[k], motion_[this->active(this->sites_[sites_of_[k]].step)], row);
}

template <class T> void Efp<T>::add_pairs() {
  std::fill(on_path_.begin(), on_path_.end(), 0);
  count_ = 0;
  for (auto tree = trees_.begin(); tree + 1 < trees_.end(); ++tree) {
    for (int k = tree->first_site; k < tree[1].first_site; ++k) {
      const int site = sites_of_[k], step = this->sites_[site].step;
      for (int s = this->sites_[site].first_slot; s < this->sites_[site + 1].first_slot; ++s)
        if (this->slots_[s].joint < 0) add_row(*tree, this->slots_[s].row, step, this->kappa_[s], -1, Six<T>::zero(), site);
    }
    for (int k = tree->first_step; k < tree[1].first_step; ++k) {
      const int i = steps_[k], p = this->plan_.parent[i];
      const auto joint = this->factor_M_.joint(i);
      const auto after = [&](int step) {  // the first site beyond `step`, or at it
        return static_cast<int>(std::lower_bound(this->sites_.begin(), this->sites_.end() - 1, step, [](const auto& a, int b) { return a.step < b; }) - this->sites_.begin());
      };
      this->factor_M_.for_joint_rows(i, [&](int row, const T* k_row) {
        const Six<T> push = this->motion_of(joint, k_row);
        if (p < 0) add_row(*tree, row, -1, Six<T>::zero(), i, push, after(i + 1));
        else add_row(*tree, row, p, this->kappa_[this->slot_of_joint_[row]], i, push, after(p));
      });
    }
  }
}

template <class T> Index Efp<T>::pair_bytes() const {
  return static_cast<Index>((steps_.size() + sites_of_.size() + on_path_.size()) * sizeof(int) + trees_.size() * sizeof(OfTree) +
                            (force_.size() + motion_.size()) * sizeof(Six<T>));
}

#define DELASSUS_INSTANTIATE(T) template class Efp<T>;
DELASSUS_FOR_EACH_SCALAR(DELASSUS_INSTANTIATE)

}  // namespace delassus
