#include "algorithms/errors/message.h"
#include "algorithms/kit/counted.h"
#include "algorithms/kit/quad.h"
#include "algorithms/mechanism/constraints.h"
#include "algorithms/mechanism/regularity.h"

#include <algorithm>
#include <cmath>

namespace delassus {
namespace {

using Kind = Constraint::Kind;

std::string element_of(const Constraint& c) {
  return std::string(name(c.kind)) + " constraint" + (c.name.empty() ? "" : " " + c.name);
}

Index body_count(const Model& model) { return static_cast<Index>(model.bodies.size()); }

void check_range(const Model& model, Index body, Index lowest, const std::string& file, const std::string& element) {
  if (body < lowest || body >= body_count(model))
    throw ModelError(file, element, "body " + std::to_string(body) + " does not exist",
                     (lowest == ground ? "-1 (the world) to " : "0 to ") + std::to_string(body_count(model) - 1) + "; add the bodies first");
}

void check_frames(const Model& model, const Constraint& c, const std::string& file, const std::string& element) {
  for (const Frame* f : {&c.a, &c.b}) {
    check_range(model, f->body, ground, file, element);
    check_pose(f->placement, file, element + (f == &c.a ? " frame a" : " frame b"));
  }
  if (c.a.body == c.b.body)
    throw ModelError(file, element,
                     c.a.body == ground ? "both frames are fixed in the world"
                                        : "both frames are on " + model.bodies[c.a.body].name,
                     "frames on two different bodies, or on one body and the world; move one frame to another body");
}

void check_terms(const Model& model, const Constraint& c, const std::string& file, const std::string& element) {
  if (c.terms.empty()) throw ModelError(file, element, "has no terms", "1 or more; add a term, or leave the constraint out");
  bool moves = false;
  for (const Constraint::Term& t : c.terms) {
    check_range(model, t.body, c.kind == Kind::general ? ground : 0, file, element);
    moves = moves || t.body != ground;
    if (c.kind == Kind::general) {
      if (t.K.rows() < 1 || t.K.rows() != c.terms.front().K.rows() || t.K.cols() != 6)
        throw ModelError(file, element, "K of " + std::to_string(t.K.rows()) + " x " + std::to_string(t.K.cols()),
                         "the same number of rows (1 or more) in every term, 6 columns; fill up with rows of 0");
      if (!t.K.allFinite()) throw ModelError(file, element, "K is not finite", "finite numbers; compute it again from finite ones");
      continue;
    }
    const Index n = dof_count(model.bodies[t.body].joint.type);
    if (t.dof < 0 || t.dof >= n)
      throw ModelError(file, element, "degree of freedom " + std::to_string(t.dof) + " of " + model.bodies[t.body].name,
                       "0 to " + std::to_string(n - 1) + "; count from 0");
    if (!std::isfinite(t.coefficient)) throw ModelError(file, element, "coefficient is not finite, " + number_text(t.coefficient), "finite numbers; leave the term out for 0");
  }
  if (!moves) throw ModelError(file, element, "every term is on the ground", "a term on a body; leave the constraint out when nothing moves");
}

}  // namespace

bool acts_on_joint(Kind kind) { return kind == Kind::joint_friction || kind == Kind::joint_lock || kind == Kind::joint_limit; }

bool has_closure(Kind kind) {
  return !acts_on_joint(kind) && kind != Kind::coupling && kind != Kind::general;
}

std::vector<Index> attached_bodies(const Model& model, const Constraint& c) {
  std::vector<Index> on;
  const auto add = [&on](Index body) {
    if (body != ground && std::find(on.begin(), on.end(), body) == on.end()) on.push_back(body);
  };
  if (has_closure(c.kind)) add(c.a.body), add(c.b.body);
  for (const Constraint::Term& t : c.terms) {
    if (c.kind == Kind::coupling) add(t.body), add(model.bodies[t.body].parent);
    if (c.kind == Kind::general) add(t.body);
  }
  return on;
}

void validate_constraint(const Model& model, const Constraint& c, const std::string& file) {
  const std::string element = element_of(c);
  if (has_closure(c.kind)) check_frames(model, c, file, element);
  else if (acts_on_joint(c.kind)) check_range(model, c.a.body, 0, file, element);
  else check_terms(model, c, file, element);
  if (c.kind == Kind::joint_limit) {
    const Index n = dof_count(model.bodies[c.a.body].joint.type);
    if (c.dof < 0 || c.dof >= n)
      throw ModelError(file, element, "degree of freedom " + std::to_string(c.dof) + " of " + model.bodies[c.a.body].name,
                       "0 to " + std::to_string(n - 1) + "; count from 0");
    if (c.side != 1 && c.side != -1) throw ModelError(file, element, "side " + std::to_string(c.side), "1 (lower) or -1 (upper); two constraints for both sides");
  }
  if (c.kind == Kind::distance && (!(c.length > 0) || std::isinf(c.length)))
    throw ModelError(file, element + " length", number_text(c.length) + " m", "finite and above 0 m; a point constraint holds two points together");
  if (!std::isfinite(c.friction))
    throw ModelError(file, element + " friction", number_text(c.friction), "a finite number; a negative one stands for none");
  if (c.loop && !has_closure(c.kind))
    throw ModelError(file, element, "is marked as a loop but has no position level",
                     "loops between two frames only; leave the mark out");
}

template <class T> End<T> end_of(const Poses<T>& poses, const Frame& frame) {
  const Matrix3<T> R = rotation_as<T>(frame.placement.rotation);
  const Vector3<T> p = frame.placement.translation.template cast<T>();
  if (frame.body == ground) return {ground, ground, R, Vector3<T>::Constant(T(0)), p};
  const Index i = frame.body, tree = poses.tree[i];
  return {i, tree, poses.rotation[i] * R, poses.position[i] + poses.rotation[i] * p, poses.reference[tree]};
}

#define DELASSUS_INSTANTIATE(T) template End<T> end_of<T>(const Poses<T>&, const Frame&);
DELASSUS_INSTANTIATE(double)
DELASSUS_INSTANTIATE(float)
DELASSUS_INSTANTIATE(Quad)
DELASSUS_INSTANTIATE(Counted)
#undef DELASSUS_INSTANTIATE

}  // namespace delassus
