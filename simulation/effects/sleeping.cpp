#include "simulation/effects/sleeping.h"

#include <algorithm>
#include <cmath>

#include "algorithms/kit/counted.h"
#include "algorithms/kit/index.h"

namespace delassus::simulation {
namespace {

}  // namespace

template <class T>
Sleeping<T>::Sleeping(const Model& model, const SceneMotion::Sleeping& limits, double step, const std::vector<DetectionTerm<T>*>& detections)
    : linear_(limits.linear), angular_(limits.angular), steps_(std::max<std::int64_t>(1, std::llround(std::ceil(limits.after / step)))), detections_(&detections) {
  for (std::size_t i = 0; i < model.bodies.size(); ++i) {
    const Index parent = model.bodies[i].parent;
    tree_.push_back(parent == ground ? static_cast<Index>(dofs_.size()) : tree_[z(parent)]);
    if (parent == ground) dofs_.emplace_back();
    dofs_[z(tree_[i])].push_back({model.first_dof[i], model.first_dof[i + 1]});
  }
  label_.assign(dofs_.size(), -1);
  quiet_.assign(dofs_.size(), 0);
  falls_ = quiet_;
  resting_.assign(tree_.size(), 0);
  speeds_.assign(tree_.size(), Six<T>::zero());
}

template <class T> bool Sleeping<T>::rests(Moment<T>& now) {
  now.resting = nullptr;
  if (looked_ && !any_) return false;
  const auto& rest = now.state->rest;
  bool all = looked_;
  for (std::size_t t = 0; t < label_.size(); ++t) {
    label_[t] = rest.empty() ? -1 : rest[t].island;
    all = all && label_[t] >= 0 && rest[t].known;
  }
  any_ = std::any_of(label_.begin(), label_.end(), [](Index label) { return label >= 0; });
  for (std::size_t i = 0; any_ && i < tree_.size(); ++i) resting_[i] = label_of(static_cast<Index>(i)) >= 0;
  if (any_) now.resting = &resting_;
  looked_ = true;
  return all;
}

template <class T> void Sleeping<T>::wake(Index label) {
  for (std::size_t i = 0; i < tree_.size(); ++i)
    if (label_of(static_cast<Index>(i)) == label) resting_[i] = 0;
  std::replace(label_.begin(), label_.end(), label, Index{-1});
}

/// Wakes what touches something awake.
template <class T> bool Sleeping<T>::touched(const Moment<T>& now) {
  bool woke = false;
  for (const auto& t : now.touching) {
    if (t.point.other == ground) continue;
    const Index a = label_of(t.point.body), b = label_of(t.point.other);
    if ((a < 0) == (b < 0)) continue;
    wake(std::max(a, b));
    woke = true;
  }
  return woke;
}

template <class T> void Sleeping<T>::look_again(Moment<T>& now) {
  do {
    now.touching.clear();
    for (DetectionTerm<T>* term : *detections_)
      if (term != static_cast<DetectionTerm<T>*>(this)) term->detect(now);
  } while (touched(now));
}

template <class T> void Sleeping<T>::detect(Moment<T>& now) {
  if (any_ && touched(now)) look_again(now);
}

template <class T> void Sleeping<T>::add_force(Moment<T>& now) {
  if (!any_) return;
  const auto& rest = now.state->rest;
  bool woke = false;
  for (std::size_t t = 0; t < label_.size(); ++t) {
    if (label_[t] < 0 || !rest[t].known) continue;
    bool same = true;
    for (const Range& r : dofs_[t])
      for (Index k = r.first; k < r.end; ++k) same = same && (*now.force)[k] == now.state->rest_force[k];
    if (same) continue;
    wake(label_[t]);
    woke = true;
  }
  if (woke) look_again(now);
}

/// Which trees are quiet at the end of the step, by the frames at its start.
template <class T> void Sleeping<T>::measure(Moment<T>& now, const VectorX<T>& nu) {
  const Problem<T>& p = *now.problem;
  const Structure& s = *p.structure;
  const Poses<T>& at = now.poses();
  const T fastest(linear_ * std::abs(linear_)), fastest_turn(angular_ * std::abs(angular_));  // below 0: never
  for (Index i = 0; i < s.bodies(); ++i) {
    std::uint8_t& quiet = quiet_[z(tree_[z(i)])];
    const bool root = s.parent[i] == ground;
    if (root) quiet = 1;
    if (quiet == 0) continue;  // whatever the others of its tree do
    Six<T> v = root ? Six<T>::zero() : speeds_[z(s.parent[i])];
    if (now.resting == nullptr || resting_[z(i)] == 0)
      for (Index k = s.first_dof[i]; k < s.first_dof[i + 1]; ++k) add_scaled(v, load(p.S[z(k)]), nu[k]);
    speeds_[z(i)] = v;
    const Vector3<T> omega(v[0], v[1], v[2]), linear = Vector3<T>(v[3], v[4], v[5]) + omega.cross(at.position[z(i)]);
    if (!(omega.dot(omega) <= fastest_turn && linear.dot(linear) <= fastest)) quiet = 0;
  }
}

/// At rest (q ⊕ h 0 is q in every bit), with the force that is on it.
template <class T> void Sleeping<T>::stay(const Moment<T>& now, State<T>& next, std::size_t tree) const {
  for (const Range& r : dofs_[tree])
    for (Index k = r.first; k < r.end; ++k) {
      next.nu[k] = T(0);
      next.rest_force[k] = (*now.force)[k];
    }
  next.rest[tree].known = true;
}

template <class T> void Sleeping<T>::after(Moment<T>& now, State<T>& next) {
  if (next.rest.size() != label_.size()) {
    next.rest.resize(label_.size());
    next.rest_force = VectorX<T>::Constant(next.nu.size(), T(0));
  }
  measure(now, next.nu);
  bool long_enough = false;
  for (std::size_t t = 0; t < label_.size(); ++t) {
    auto& rest = next.rest[t];
    if (label_[t] >= 0) {
      stay(now, next, t);
      continue;
    }
    rest.quiet = quiet_[t] != 0 ? (rest.island >= 0 ? 1 : rest.quiet + 1) : 0;
    rest.island = -1;
    long_enough = long_enough || rest.quiet >= steps_;
  }
  if (long_enough) fall(next, *now.island);
}

/// Islands of which no tree sleeps, and all have been quiet.
template <class T> void Sleeping<T>::fall(State<T>& next, const std::vector<Index>& island) {
  std::fill(falls_.begin(), falls_.end(), std::uint8_t{1});
  for (std::size_t t = 0; t < label_.size(); ++t)
    if (label_[t] >= 0 || next.rest[t].quiet < steps_) falls_[z(island[t])] = 0;
  for (std::size_t t = 0; t < label_.size(); ++t) {
    if (falls_[z(island[t])] == 0) continue;
    any_ = true;
    next.rest[t].island = island[t];
    next.rest[t].known = false;
    for (const Range& r : dofs_[t])
      for (Index k = r.first; k < r.end; ++k) next.nu[k] = T(0);
  }
}

template <class T> Index Sleeping<T>::bytes() const {
  return static_cast<Index>(sizeof(*this) + tree_.size() * (sizeof(Index) + sizeof(Six<T>) + 1 + sizeof(Range)) + label_.size() * (sizeof(Index) + 2));
}

template class Sleeping<double>;
template class Sleeping<Counted>;

}  // namespace delassus::simulation
