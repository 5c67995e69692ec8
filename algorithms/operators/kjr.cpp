#include "algorithms/operators/kjr.h"

#include "algorithms/kit/instantiate.h"

namespace delassus {

template <class T> void Kjr<T>::outwards(const int* begin, const int* end, SixBySix<T>& X) const {
  while (end != begin) {
    const auto joint = this->factor_M_.joint(*--end);
    for (int c = 0; c < 6; ++c) carry_outwards(joint, X.column[c]);
  }
}

// Ω_ij of two sites in one tree, and their rows
template <class T> void Kjr<T>::add_bodies(int i, int j) {
  int *const of_i = path_.data(), *const of_j = of_i + this->plan_.active();
  int depth_i = 0, depth_j = 0, a = this->sites_[i].step, b = this->sites_[j].step;
  while (a != b)
    if (a < b) of_i[depth_i++] = a, a = this->plan_.parent[a];
    else of_j[depth_j++] = b, b = this->plan_.parent[b];
  SixBySix<T> X = copied(this->omega_[this->active(a)]);
  outwards(of_j, of_j + depth_j, X);
  X = transposed(X);
  outwards(of_i, of_i + depth_i, X);
  this->add_motions(i, X, j);
}

// The rows on every joint between a site and the root, each carried out to it
template <class T> void Kjr<T>::add_joints_of(int site) {
  int depth = 0;
  for (int a = this->sites_[site].step; a >= 0; path_[depth++] = a, a = this->plan_.parent[a]) {
    const auto joint = this->factor_M_.joint(a);
    this->factor_M_.for_joint_rows(a, [&](int row, const T* k) {
      Six<T> motion = this->motion_of(joint, k);
      for (int d = depth; d-- > 0;) carry_outwards(this->factor_M_.joint(path_[d]), motion);
      this->add_motion(site, motion, row);
    });
  }
}

template <class T> void Kjr<T>::add_pairs() {
  for (int j = 0; j < this->sites(); ++j) {
    for (int i = 0; i < j; ++i)
      if (this->same_tree(this->sites_[i].step, this->sites_[j].step)) add_bodies(i, j);
    add_joints_of(j);
  }
}

#define DELASSUS_INSTANTIATE(T) template class Kjr<T>;
DELASSUS_FOR_EACH_SCALAR(DELASSUS_INSTANTIATE)

}  // namespace delassus
