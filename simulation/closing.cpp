#include "simulation/closing.h"

#include "algorithms/kit/counted.h"
#include "algorithms/mechanism/constraints.h"
#include "algorithms/mechanism/loop_closing.h"

namespace delassus::simulation {

template <class T>
Closing<T>::Closing(const Model& model, Mechanism<T>& mechanism, EquationsPath<T>& path)
    : model_(&model), mechanism_(&mechanism), path_(&path), advance_(model) {
  gap_ = gap_then_ = VectorX<T>::Constant(mechanism.structure()->rows, T(0));
}

template <class T> T Closing<T>::error(const VectorX<T>& q, VectorX<T>& gap) {
  using std::abs;
  mechanism_->update(q);
  mechanism_->poses(poses_);
  T largest(0);
  Index row = 0;
  for (const Constraint& c : model_->constraints) {
    const VectorX<T> e = closure_error(*model_, c, poses_);
    for (Index k = 0; k < e.size(); ++k) {
      gap[row++] = e[k];
      if (abs(e[k]) > largest) largest = abs(e[k]);
    }
  }
  return largest;
}

template <class T> void Closing<T>::after(Moment<T>& now, State<T>& next) {
  T open = error(next.q, gap_);
  now.drift = static_cast<double>(open);
  for (int k = 0; k < 5 && open > T(closed); ++k) {
    if (!path_->correct(gap_, d_).ok()) break;
    q_ = next.q;
    advance_.displace(d_, q_);
    const T then = error(q_, gap_then_);
    if (!(then < open)) break;
    const bool halved = then + then < open;
    next.q = q_;
    gap_.swap(gap_then_);
    open = then;
    if (!halved) break;
  }
  now.left = static_cast<double>(open);
}

template <class T> Index Closing<T>::bytes() const {
  return static_cast<Index>(sizeof(*this)) + static_cast<Index>(sizeof(T)) * (2 * gap_.size() + 2 * model_->q_size()) +
         static_cast<Index>(model_->bodies.size() * (sizeof(Matrix3<T>) + 2 * sizeof(Vector3<T>) + sizeof(Index)));
}

template class Closing<double>;
template class Closing<Counted>;

}  // namespace delassus::simulation
