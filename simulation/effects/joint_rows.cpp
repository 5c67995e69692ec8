#include "simulation/effects/joint_rows.h"

#include <cmath>
#include <map>

#include "algorithms/kit/counted.h"

namespace delassus::simulation {
namespace {

template <class Take> void each_limit(const Model& model, Take&& take) {
  for (std::size_t i = 0; i < model.bodies.size(); ++i) {
    const Joint& j = model.bodies[i].joint;
    for (const int side : {1, -1}) {
      const std::vector<double>& limit = side > 0 ? j.lower : j.upper;
      for (std::size_t k = 0; k < limit.size(); ++k) {
        const Index body = static_cast<Index>(i), dof = static_cast<Index>(k), q = SceneMotion::coordinate(model, body, dof);
        if (q >= 0 && std::isfinite(limit[k])) take(body, dof, q, side, limit[k]);
      }
    }
  }
}

}  // namespace

Index limit_count(const Scene& scene) {
  Index n = 0;
  each_limit(scene.model, [&](Index, Index, Index, int, double) { ++n; });
  return n;
}

std::vector<FrictionOfJoint> joint_frictions(const Scene& scene) {
  std::map<std::pair<Index, Index>, double> efforts;
  for (std::size_t i = 0; i < scene.model.bodies.size(); ++i) {
    const std::vector<double>& f = scene.model.bodies[i].joint.friction;
    for (std::size_t k = 0; k < f.size(); ++k) efforts[{static_cast<Index>(i), static_cast<Index>(k)}] = f[k];
  }
  for (const Constraint& c : scene.model.constraints)
    if (c.kind == Constraint::Kind::joint_friction && c.friction > 0)
      for (Index k = 0; k < row_count(scene.model, c); ++k) efforts[{c.a.body, k}] = c.friction;
  std::vector<FrictionOfJoint> out;
  for (const auto& [joint, effort] : efforts)
    if (effort > 0) out.push_back({joint.first, joint.second, effort});
  return out;
}

template <class T> JointLimits<T>::JointLimits(const Model& model) {
  each_limit(model, [&](Index body, Index dof, Index q, int side, double value) {
    limits_.push_back({body, dof, model.first_dof[static_cast<std::size_t>(body)] + dof, q, side, T(value)});
  });
}

template <class T> void JointLimits<T>::add_rows(Moment<T>& now) {
  for (const Limit& l : limits_) {
    const T gap = T(l.side) * (now.state->q[l.q] - l.value), rate = T(l.side) * now.state->nu[l.at];
    if (gap > T(limit_reach) && gap + T(2) * now.h * rate > T(limit_reach)) continue;
    RowSet<T> s;
    s.kind = RowSet<T>::Kind::limit;
    s.identity = {1, l.body, l.dof, l.side};
    s.body = l.body, s.dof = l.dof, s.side = l.side;
    s.gap = gap;
    s.target = target_of_gap(gap, now.h);
    now.rows->push_back(s);
  }
}

template <class T> void JointFriction<T>::add_rows(Moment<T>& now) {
  for (const FrictionOfJoint& f : joints_) {
    RowSet<T> s;
    s.kind = RowSet<T>::Kind::joint_friction;
    s.identity = {2, f.body, f.dof, 0};
    s.body = f.body, s.dof = f.dof;
    s.effort = now.h * T(f.effort);
    now.rows->push_back(s);
  }
}

template class JointLimits<double>;
template class JointLimits<Counted>;
template class JointFriction<double>;
template class JointFriction<Counted>;

}  // namespace delassus::simulation
