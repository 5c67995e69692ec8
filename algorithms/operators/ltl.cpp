#include "algorithms/operators/ltl.h"

#include <algorithm>

#include "algorithms/kit/instantiate.h"

namespace delassus {

template <class T> void Ltl<T>::analyze_form() {
  factor_.analyze(*this->structure());
  rows_.analyze(*this->structure(), factor_);
}

template <class T> void Ltl<T>::subtract_rates(const T* r1, T* x, T* work) const {
  std::copy(r1, r1 + factor_.dofs(), work);
  factor_.solve_transposed(work);
  rows_.subtract_scaled(work, x);
}

template <class T> void Ltl<T>::motion(const T*, const T* lambda, T* nu, T* work) const {
  rows_.add_transposed(lambda, work);
  factor_.solve_scaled(work);
  std::copy(work, work + factor_.dofs(), nu);
}

#define DELASSUS_INSTANTIATE(T) template class Ltl<T>;
DELASSUS_FOR_EACH_SCALAR(DELASSUS_INSTANTIATE)

}  // namespace delassus
