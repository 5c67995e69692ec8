#include "algorithms/operators/mobility_form.h"

#include <algorithm>
#include <tuple>

#include "algorithms/kit/instantiate.h"

namespace delassus {

template <class T> void MobilityForm<T>::analyze_form() {
  ExplicitBySweeps<T>::analyze_form();
  const Structure& s = *this->structure();
  const Plan& plan = this->plan_;
  const std::size_t steps = static_cast<std::size_t>(plan.active());
  struct Origin {
    int step, row, joint, k;
  };
  std::vector<Origin> starts;
  with_rows_.assign(steps, 0);
  for (const auto& e : s.link_constraints)
    for (const auto& link : e.links)
      for (Index r = 0; r < e.rows; ++r) starts.push_back({plan.step[link.body], static_cast<int>(e.row + r), -1, static_cast<int>(link.first + r)});
  for (const auto& j : s.joint_constraints) {
    const int i = plan.step[j.body];
    with_rows_[active(i)] = 1;
    for (Index r = 0; r < j.rows && plan.parent[i] >= 0; ++r) starts.push_back({plan.parent[i], static_cast<int>(j.row + r), i, -1});
  }
  std::sort(starts.begin(), starts.end(), [](const Origin& a, const Origin& b) { return std::tie(a.step, a.row) < std::tie(b.step, b.row); });
  slots_.clear(), sites_.clear(), runs_.clear();
  slot_of_k_.assign(static_cast<std::size_t>(s.K_rows), 0);
  slot_of_joint_.assign(static_cast<std::size_t>(s.rows), -1);
  for (std::size_t b = 0, e = 0; b < starts.size(); b = e) {
    while (e < starts.size() && starts[e].step == starts[b].step) ++e;
    sites_.push_back({starts[b].step, static_cast<int>(b), static_cast<int>(runs_.size())});
    append_runs(runs_, static_cast<int>(b), static_cast<int>(e - b), [&](int k) { return starts[b + static_cast<std::size_t>(k)].row; });
  }
  for (std::size_t k = 0; k < starts.size(); ++k) {
    slots_.push_back({starts[k].row, starts[k].joint});
    (starts[k].joint < 0 ? slot_of_k_[static_cast<std::size_t>(starts[k].k)] : slot_of_joint_[static_cast<std::size_t>(starts[k].row)]) = static_cast<int>(k);
  }
  sites_.push_back({plan.steps, static_cast<int>(starts.size()), static_cast<int>(runs_.size())});
  tree_.assign(steps, -1);
  for (int i = plan.steps; i-- > plan.first_active;) tree_[active(i)] = plan.parent[i] < 0 ? i : tree_[active(plan.parent[i])];
  kappa_.assign(slots_.size(), Six<T>::zero());
  omega_.assign(steps, SixBySix<T>::zero());
  x_.assign(6 * slots_.size() + 7, T(0));
  y_ = x_;
  sums_.analyze(std::max<Index>(s.rows, static_cast<Index>(slots_.size())), 6);
  analyze_pairs();
}

// κ of every row, and Ω of every body
template <class T> void MobilityForm<T>::take_rows(const Problem<T>& problem) {
  const Plan& plan = this->plan_;
  for (std::size_t k = 0; k < slot_of_k_.size(); ++k) kappa_[slot_of_k_[k]] = load(problem.K[k]);
  for (int i = plan.steps; i-- > plan.first_active;) {
    const int p = plan.parent[i];
    const auto joint = this->factor_M_.joint(i);
    omega_[active(i)] = mobility(joint, p < 0 ? nullptr : &omega_[active(p)]);
    if (p < 0) continue;
    this->factor_M_.for_joint_rows(i, [&](int row, const T* k) {
      Six<T>& force = kappa_[slot_of_joint_[row]] = Six<T>::zero();
      for (int c = 0; c < joint.dofs; ++c) subtract_scaled(force, joint.w[c], k[c]);
    });
  }
  for (Index k = 0; k < stride(); ++k)
    for (int c = 0; c < 6; ++c) x_[c * stride() + k] = kappa_[k][c];
}

template <class T> void MobilityForm<T>::add_sites() {
  for (int j = 0; j < sites(); ++j) {
    move(omega_[active(sites_[j].step)], j);
    sums_.add_own_pairs(side(j, x_.data()), side(j, y_.data()), nullptr, 6);
  }
}

template <class T> void MobilityForm<T>::add_joints() {
  for (int i = this->plan_.first_active; i < this->plan_.steps; ++i) {
    const auto joint = this->factor_M_.joint(i);
    this->factor_M_.for_joint_rows(i, [&](int row, const T* k) {
      this->factor_M_.for_joint_rows(i, [&](int other, const T* l) {
        if (other > row) return;
        T sum(0);
        for (int c = 0; c < joint.dofs; ++c) sum += k[c] * joint.d_inverse[c] * l[c];
        if (other == row) sums_.add_own(row, sum);
        else sums_.add(row, other, sum);
      });
    });
  }
}

template <class T> void MobilityForm<T>::form(const Problem<T>& problem, MatrixX<T>& A0) {
  this->factor_M_.move_rows(problem);
  take_rows(problem);
  sums_.start(A0);
  add_sites();
  add_joints();
  add_pairs();
  sums_.finish();
}

template <class T> Index MobilityForm<T>::form_bytes() const {
  const auto ints = slot_of_k_.size() + slot_of_joint_.size() + tree_.size();
  return ExplicitBySweeps<T>::form_bytes() + sums_.bytes() + pair_bytes() +
         static_cast<Index>(ints * sizeof(int) + sites_.size() * sizeof(Site) + slots_.size() * sizeof(Slot) + runs_.size() * sizeof(RowRun) +
                            kappa_.size() * sizeof(Six<T>) + omega_.size() * sizeof(SixBySix<T>) + (x_.size() + y_.size()) * sizeof(T) + with_rows_.size());
}

#define DELASSUS_INSTANTIATE(T) template class MobilityForm<T>;
DELASSUS_FOR_EACH_SCALAR(DELASSUS_INSTANTIATE)

}  // namespace delassus
