#include "simulation/effects/contacts.h"

#include <algorithm>

#include "algorithms/kit/counted.h"
#include "models/shapes/between.h"

namespace delassus::simulation {
namespace {

/// The frames in double: themselves, or written to `out`.
const Poses<double>& in_double(const Poses<double>& p, Poses<double>&) { return p; }
template <class T> const Poses<double>& in_double(const Poses<T>& p, Poses<double>& out) {
  out = {};
  out.tree = p.tree;
  const auto each = [](const auto& x) { return x.unaryExpr([](const T& v) { return static_cast<double>(v); }).eval(); };
  for (const auto& R : p.rotation) out.rotation.push_back(each(R));
  for (const auto& x : p.position) out.position.push_back(each(x));
  for (const auto& x : p.reference) out.reference.push_back(each(x));
  return out;
}

double reach_of(const Body& b) {
  double reach = 0;
  for (const Shape& s : b.shapes) reach = std::max(reach, s.placement.translation.norm() + s.size.norm() + s.size[0]);
  return reach;
}

/// Motion of a body, from its tree's reference point.
template <class T> Vector6<T> twist_of(const Problem<T>& p, const VectorX<T>& nu, Index body) {
  Vector6<T> twist = Vector6<T>::Constant(T(0));
  const Structure& s = *p.structure;
  for (Index i = body; i != ground; i = s.parent[i])
    for (Index k = s.first_dof[i]; k < s.first_dof[i + 1]; ++k) twist += p.S[k] * nu[k];
  return twist;
}

template <class T> Vector3<T> velocity_at(const Vector6<T>& twist, const Vector3<T>& point) {
  const Vector3<T> omega = twist.template head<3>();
  return twist.template tail<3>() + omega.cross(point);
}

}  // namespace

bool has_listed_contacts(const Scene& scene) {
  const auto& all = scene.model.constraints;
  return !scene.motion.detects && std::any_of(all.begin(), all.end(), [](const Constraint& c) { return c.kind == Constraint::Kind::contact; });
}

template <class T>
Detection<T>::Detection(const Scene& scene)
    : search_(scene.motion.search), friction_(scene.motion.friction), ground_friction_(scene.ground_friction), R_inverse_(scene.motion.contact_damping), between_(scene.motion.between) {
  for (const Body& b : scene.model.bodies) reach_.push_back(reach_of(b));
  speeds_.resize(scene.model.bodies.size());
  search_.hulls = hull_surfaces(scene.model, search_.standing);
}

/// As far as each body comes in two steps: two of them towards each other in one.
template <class T> void Detection<T>::look_ahead(Moment<T>& now, const Poses<double>& at) {
  const Problem<T>& p = *now.problem;
  const Structure& s = *p.structure;
  search_.ahead.resize(speeds_.size());
  for (Index i = 0; i < s.bodies(); ++i) {
    speeds_[i].setZero();
    if (s.parent[i] != ground) speeds_[i] = speeds_[s.parent[i]];
    for (Index k = s.first_dof[i]; k < s.first_dof[i + 1]; ++k)
      for (Index c = 0; c < 6; ++c) speeds_[i][c] += static_cast<double>(p.S[k][c]) * static_cast<double>(now.state->nu[k]);
    const Vector3<double> omega = speeds_[i].head<3>(), v = speeds_[i].tail<3>() + omega.cross(at.position[i]);
    search_.ahead[i] = 2 * static_cast<double>(now.h) * (v.norm() + omega.norm() * reach_[i]);
  }
}

template <class T> void Detection<T>::detect(Moment<T>& now) {
  Poses<double> rounded;
  const Poses<double>& at = in_double(now.poses(), rounded);
  look_ahead(now, at);
  search_.resting = now.resting;
  notes_.clear();
  for (ContactPoint p : find_contacts(*now.model, at, search_, notes_)) {
    if (p.friction < 0 || (p.other == ground && p.standing < 0 && ground_friction_ >= 0)) p.friction = ground_friction_;
    if (friction_ >= 0) p.friction = friction_;
    if (between_.empty()) {
      now.touching.push_back({p, R_inverse_});
      continue;
    }
    const auto own = own_coefficients(between_, p);
    if (own.friction >= 0) p.friction = own.friction;
    now.touching.push_back({p, R_inverse_, own.torsional, own.rolling, own.restitution});
  }
}

template <class T> Contacts<T>::Contacts(const Scene& scene) {
  if (scene.motion.detects) return;
  Poses<double> at;
  poses(scene.model, scene.q, at);
  Index row = 0;
  for (const Constraint& c : scene.model.constraints) {
    const Index first = row;
    row += row_count(scene.model, c);
    if (c.kind != Constraint::Kind::contact) continue;
    const Vector3<double> normal = relative_pose(at, c.b.body, c.a.body).rotation * c.a.placement.rotation.col(2);
    const auto r = static_cast<std::size_t>(first);
    listed_.push_back({c.a.body, c.b.body, c.a.placement.translation, c.b.placement.translation, normal, c.friction,
                       r < scene.damping.diagonal.size() ? scene.damping.diagonal[r] : 0});
  }
}

template <class T> void Contacts<T>::detect(Moment<T>& now) {
  if (listed_.empty()) return;
  Poses<double> rounded;
  const Poses<double>& at = in_double(now.poses(), rounded);
  for (const Listed& c : listed_) {
    const Pose<double> other = relative_pose(at, c.body, c.other);
    const auto i = static_cast<std::size_t>(c.body);
    const Vector3<double> normal = at.rotation[i] * (other.rotation * c.normal);
    const Vector3<double> point = at.position[i] + at.rotation[i] * c.point, apart = at.rotation[i] * (c.point - other * c.foot);
    now.touching.push_back({{c.body, c.other, point, normal, normal.dot(apart), c.friction}, c.R_inverse});
  }
}

template <class T> void Contacts<T>::add_rows(Moment<T>& now) {
  const Poses<T>& at = now.poses();
  const auto reference = [&](Index body) { return at.reference[static_cast<std::size_t>(at.tree[static_cast<std::size_t>(body)])]; };
  for (const auto& touching : now.touching) {
    const ContactPoint& p = touching.point;
    RowSet<T> s;
    s.kind = RowSet<T>::Kind::contact;
    s.body = p.body, s.other = p.other;
    s.identity = {0, p.body, p.other, p.feature};
    s.point = p.point.template cast<T>();
    s.point_of_other = s.point;
    if (p.other != ground) s.point_of_other += reference(p.body) - reference(p.other);
    const Matrix3<double> axes = frame_about(p.normal);
    s.axes.col(0) = axes.col(2).template cast<T>(), s.axes.col(1) = axes.col(0).template cast<T>(), s.axes.col(2) = axes.col(1).template cast<T>();
    s.gap = T(p.gap);
    s.friction = T(p.friction);
    s.target = target_of_gap(s.gap, now.h);
    s.R_inverse = T(touching.R_inverse);
    now.rows->push_back(s);
  }
}

template <class T> void ContactFriction<T>::add_rows(Moment<T>& now) {
  for (RowSet<T>& s : *now.rows)
    if (s.kind == RowSet<T>::Kind::contact && s.friction > T(0)) s.directions = 3, s.tangents = true, s.coefficient = s.friction;
}

template <class T> void Restitution<T>::add_rows(Moment<T>& now) {
  const VectorX<T>& nu = now.state->nu;
  auto touching = now.touching.begin();  // a row set each, in this order
  const RowSet<T>* last = nullptr;
  Vector6<T> twist, of_other;
  for (RowSet<T>& s : *now.rows) {
    if (s.kind != RowSet<T>::Kind::contact) continue;
    const double own = (touching++)->restitution;
    const T e = own >= 0 ? T(own) : e_;
    if (!(e > T(0))) continue;
    if (last == nullptr || last->body != s.body || last->other != s.other) {
      twist = twist_of(*now.problem, nu, s.body);
      if (s.other != ground) of_other = twist_of(*now.problem, nu, s.other);
    }
    last = &s;
    Vector3<T> v = velocity_at(twist, s.point);
    if (s.other != ground) v -= velocity_at(of_other, s.point_of_other);
    const T approach = Vector3<T>(s.axes.col(0)).dot(v);
    if (approach < T(-bounce_speed) && s.gap + now.h * approach <= T(0)) s.target = std::max(s.target, T(-e * approach));
  }
}

template class Detection<double>;
template class Detection<Counted>;
template class Contacts<double>;
template class Contacts<Counted>;
template class ContactFriction<double>;
template class ContactFriction<Counted>;
template class Restitution<double>;
template class Restitution<Counted>;

}  // namespace delassus::simulation
