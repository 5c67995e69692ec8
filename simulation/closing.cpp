#include "simulation/closing.h"

#include <numeric>

#include "algorithms/kit/counted.h"
#include "algorithms/mechanism/constraints.h"
#include "algorithms/mechanism/loop_closing.h"

namespace delassus::simulation {

template <class T> ClosedTogether<T> all_of(const Model& model, EquationsPath<T>& path) {
  ClosedTogether<T> out{&path, std::vector<Index>(model.bodies.size()), {}};
  Index rows = 0;
  for (const Constraint& c : model.constraints) rows += row_count(model, c);
  out.rows.resize(static_cast<std::size_t>(rows));
  std::iota(out.bodies.begin(), out.bodies.end(), Index{0});
  std::iota(out.rows.begin(), out.rows.end(), Index{0});
  return out;
}

template <class T>
Closing<T>::Closing(const Model& model, Mechanism<T>& mechanism, std::vector<ClosedTogether<T>> loops) : model_(&model), mechanism_(&mechanism) {
  gap_ = gap_then_ = VectorX<T>::Constant(mechanism.structure()->rows, T(0));
  for (ClosedTogether<T>& l : loops) {
    Advance<T> advance(model, l.bodies);
    loops_.push_back({std::move(l), std::move(advance), T(0), T(0), false, false});
  }
}

template <class T> void Closing<T>::measure(const VectorX<T>& q, VectorX<T>& gap, T Loop::*largest) {
  using std::abs;
  mechanism_->update(q);
  mechanism_->poses(poses_);
  Index row = 0;
  for (const Constraint& c : model_->constraints) row += closure_error(*model_, c, poses_, gap.data() + row);
  for (Loop& l : loops_) {
    l.*largest = T(0);
    for (const Index r : l.of.rows)
      if (abs(gap[r]) > l.*largest) l.*largest = abs(gap[r]);
  }
}

template <class T> void Closing<T>::displace(Loop& l) {
  gap_of_.resize(static_cast<Index>(l.of.rows.size()));
  for (std::size_t k = 0; k < l.of.rows.size(); ++k) gap_of_[static_cast<Index>(k)] = gap_[l.of.rows[k]];
  l.moved = l.of.path->correct(gap_of_, d_).ok();
  if (l.moved) l.advance.displace(d_, q_);
}

/// The displaced q of its bodies, where it is closer.
template <class T> void Closing<T>::keep(Loop& l, VectorX<T>& q) {
  if (!l.moved || !(l.then < l.open)) {
    l.ends = !l.moved || !l.of.path->yield();
    return;
  }
  for (const Index i : l.of.bodies)
    for (Index k = model_->first_q[static_cast<std::size_t>(i)]; k < model_->first_q[static_cast<std::size_t>(i) + 1]; ++k) q[k] = q_[k];
  for (const Index r : l.of.rows) gap_[r] = gap_then_[r];
  l.ends = !(l.then + l.then < l.open) && !l.of.path->yield();
  l.open = l.then;
}

template <class T> void Closing<T>::after(Moment<T>& now, State<T>& next) {
  measure(next.q, gap_, &Loop::open);
  for (Loop& l : loops_) {
    l.ends = now.resting != nullptr && (*now.resting)[static_cast<std::size_t>(l.of.bodies[0])] != 0;
    if (!l.ends) now.drift = std::max(now.drift, static_cast<double>(l.open));
  }
  for (int k = 0; k < 6; ++k) {
    bool any = false;
    q_ = next.q;
    for (Loop& l : loops_) {
      l.ends = l.ends || !(l.open > T(closed));
      if (l.ends) continue;
      displace(l);
      l.ends = !l.moved;
      any = any || l.moved;
    }
    if (!any) break;
    measure(q_, gap_then_, &Loop::then);
    for (Loop& l : loops_)
      if (!l.ends) keep(l, next.q);
  }
  for (const Loop& l : loops_) now.left = std::max(now.left, static_cast<double>(l.open));
}

template <class T> Index Closing<T>::bytes() const {
  std::size_t lists = 0;
  for (const Loop& l : loops_) lists += sizeof(Loop) + (l.of.bodies.size() + l.of.rows.size()) * sizeof(Index);
  return static_cast<Index>(sizeof(*this) + lists) + static_cast<Index>(sizeof(T)) * (3 * gap_.size() + 2 * model_->q_size()) +
         static_cast<Index>(model_->bodies.size() * (sizeof(Matrix3<T>) + 2 * sizeof(Vector3<T>) + sizeof(Index)));
}

template struct ClosedTogether<double>;
template struct ClosedTogether<Counted>;
template ClosedTogether<double> all_of(const Model&, EquationsPath<double>&);
template ClosedTogether<Counted> all_of(const Model&, EquationsPath<Counted>&);
template class Closing<double>;
template class Closing<Counted>;

}  // namespace delassus::simulation
