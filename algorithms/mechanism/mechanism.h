// A mechanism compiled from its description: what a configuration turns into numbers, and nothing else.
//
// What     Per body the constants of its joint, its mass, centre and inertia; per constraint its frames, and where its rows
//          stand. Axes are of unit length and joint placements multiplied in at build, so that a revolute joint is
//            R_i = R_π (A + cos q C + sin q S),   A = P a aᵀ, C = P (1 − a aᵀ), S = P â,
//          and no name, limit or shape lies between two numbers that are read one after the other.
// Phases   update(q): world frames (see kinematics.h for reference points) · fill(problem): S, H, K.
// Cost     O(N + m); about 200 operations a body, 60 a row. Nothing allocates after the constructor.
// Threads  one Mechanism each: it holds the frames of its last update.
#pragma once

#include "algorithms/kit/three.h"
#include "algorithms/mechanism/kinematics.h"

namespace delassus {

template <class T> class Motion;

template <class T> class Mechanism {
 public:
  /// @throws ModelError as structure_of.
  explicit Mechanism(const Model& model);
  /// With a structure that structure_of(model) made. @throws std::logic_error when it is another model's.
  Mechanism(const Model& model, std::shared_ptr<const Structure> structure);
  /// The bodies alone, without constraints or a structure: for update and poses.
  [[nodiscard]] static Mechanism bodies_of(const Model& model);

  [[nodiscard]] const std::shared_ptr<const Structure>& structure() const { return structure_; }
  /// World frames at q (size q_size). @throws std::logic_error when q does not fit.
  void update(const VectorX<T>& q);
  /// S, armature, H, K and joint_K at the last q. @throws std::logic_error for a problem of another structure.
  void fill(Problem<T>& out) const;
  /// The frames at the last q.
  void poses(Poses<T>& out) const;

 private:
  friend class Motion<T>;  // reads joints, solids, rows and frames: motion.h

  struct Joint {
    JointType type;
    Index parent, tree, first_q, first_dof;
    ThreeByThree<T> placement;            // P
    ThreeByThree<T> fixed, cosine, sine;  // A, C, S of the (first) axis
    ThreeByThree<T> fixed2, cosine2, sine2;  // of the second axis of a universal joint, without P
    Three<T> axis, axis2;                 // P a, or in the plane P t₁; universal: a₂ in the joint frame
    Three<T> axis3;                       // planar: P t₂
    Three<T> shift;                       // of the placement
    Three<T> com;
  };
  struct Solid {
    bool massless;
    T mass;
    ThreeByThree<T> inertia;
  };
  struct End {
    Index body;                // ground: fixed in the world
    Index first;               // of its rows in K, −1: none
    ThreeByThree<T> rotation;  // in the body's frame, or in the world
    Three<T> position;
  };
  struct Pair {
    Constraint::Kind kind;
    Index row;
    End a, b;
  };
  struct Term {  // of a coupling or of user rows
    Index body, parent, first_dof, dofs, dof, first, first_of_parent;
    T coefficient;
    MatrixX<T> K;
  };
  struct Terms {
    Constraint::Kind kind;
    std::size_t constraint;  // of the structure's link constraints
    std::vector<Term> terms;
  };

  Mechanism() = default;
  void compile_bodies(const Model& model);
  void compile_body(const Model& model, Index i);
  void compile_constraint(const Model& model, const Constraint& c, const Structure::LinkConstraint& to, std::size_t e);
  Three<T> local(const Joint& joint, const T* q, ThreeByThree<T>& rotation) const;
  template <class Rotation, class Translation>
  void axes(const Joint& joint, Index i, Rotation rotation, Translation translation) const;
  void motion(const Joint& joint, Index i, Vector6<T>* S) const;
  void inertia(Index i, Matrix6<T>& H) const;
  [[nodiscard]] Three<T> position_of(const End& end) const;
  [[nodiscard]] Three<T> offset(const End& a, const End& b) const;
  void pair_rows(const Pair& pair, std::vector<Vector6<T>>& K) const;
  void term_rows(const Terms& terms, const std::vector<Vector6<T>>& S, std::vector<Vector6<T>>& K) const;

  std::shared_ptr<const Structure> structure_;
  std::vector<Joint> joints_;
  std::vector<Solid> solids_;
  std::vector<Pair> pairs_;
  std::vector<Terms> terms_;
  std::vector<T> armature_, joint_K_;
  Index q_size_ = 0;
  std::vector<ThreeByThree<T>> rotation_;  // world from body axes
  std::vector<Three<T>> position_;         // from the tree's reference point
  std::vector<Three<T>> reference_;        // at roots
};

// The axes of a joint's degrees of freedom in their order, world: rotation(axis) through the origin of the moved frame,
// translation(axis).
template <class T>
template <class Rotation, class Translation>
void Mechanism<T>::axes(const Joint& j, Index i, Rotation rotation, Translation translation) const {
  const ThreeByThree<T>& R = rotation_[i];
  const auto of_parent = [&](const Three<T>& x) { return j.parent == ground ? x : rotation_[j.parent] * x; };
  switch (j.type) {
    case JointType::revolute: rotation(of_parent(j.axis)); return;
    case JointType::prismatic: translation(of_parent(j.axis)); return;
    case JointType::universal: rotation(of_parent(j.axis)), rotation(R * j.axis2); return;
    case JointType::planar:
      rotation(of_parent(j.axis)), translation(of_parent(j.axis2)), translation(of_parent(j.axis3));
      return;
    case JointType::spherical:
      for (const Three<T>& column : R.column) rotation(column);
      return;
    case JointType::floating:
      for (const Three<T>& column : R.column) rotation(column);
      for (const Three<T>& column : R.column) translation(column);
      return;
    case JointType::cylindrical: {
      const Three<T> axis = of_parent(j.axis);
      rotation(axis), translation(axis);
      return;
    }
  }
}

}  // namespace delassus
