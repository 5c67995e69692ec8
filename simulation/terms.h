// What an effect may contribute to a step: terms, each an interface without flags. An effect implements those it has; the plan keeps
// a list of each, and the step is a loop over the lists.
//
//   inertia     on the diagonal of M̂                  armature, implicit damping h d and springs h² k
//   force       on the right-hand side, at q and ν       gravity, velocity products, wrenches, …
//   detection   which rows there are now
//   rows        rows with a cone, a target, a coefficient
//   event       what happens between two steps
//   rest        whether there is anything to do at all
#pragma once

#include "algorithms/mechanism/mechanism.h"
#include "models/contacts.h"
#include "simulation/cone_rows.h"
#include "simulation/state.h"

namespace delassus::simulation {

/// A step, as its terms see it: numbers at the start of the step.
template <class T> class Moment {
 public:
  Moment(const Model& scene_model, const Mechanism<T>& frames, const T& step) : model(&scene_model), mechanism(&frames), h(step), ahead(step), weight(step) {}

  const Model* model;
  const Mechanism<T>* mechanism;  ///< its frames at q
  T h;                            ///< [s] of what is implicit in M̂; 0: nothing is
  T ahead;                        ///< [s] springs pull as they would so much later; 0 where accelerations are asked for
  T weight;                       ///< what forces are multiplied with: h, or 1 where accelerations are asked for
  bool again = false;             ///< the stage of an implicit method that was evaluated last, nearer to its end
  const State<T>* state = nullptr;
  Problem<T>* problem = nullptr;  ///< S and H at q, rows that always hold; inertia terms add to its armature
  VectorX<T>* force = nullptr;    ///< n: force terms add to it [N m or N]
  std::vector<RowSet<T>>* rows = nullptr;
  struct Touching {
    ContactPoint point;
    double R_inverse;                                     ///< [1/kg]
    double torsional = -1, rolling = -1, restitution = -1;  ///< its own; negative: that of the scene
  };
  std::vector<Touching> touching;  ///< detection terms add to it
  const std::vector<std::uint8_t>* resting = nullptr;  ///< per body: 1 where it is not moved; null: all move
  const std::vector<Index>* island = nullptr;          ///< per tree: the first tree of its island in this step; of islands_path.h
  double drift = 0, left = 0;      ///< largest |φ| of equations after the step, and after closing [m or rad]

  /// Frames of the bodies; computed when the first term asks.
  [[nodiscard]] const Poses<T>& poses() {
    if (!has_poses_) mechanism->poses(poses_);
    has_poses_ = true;
    return poses_;
  }
  void start() {
    has_poses_ = false;
    problem->armature.assign(problem->armature.size(), T(0));
    force->setConstant(T(0));
    rows->clear();
    touching.clear();
    drift = left = 0;
  }

 private:
  Poses<T> poses_;
  bool has_poses_ = false;
};

template <class T> struct InertiaTerm {
  virtual ~InertiaTerm() = default;
  virtual void add_inertia(Moment<T>& now) = 0;
};
template <class T> struct ForceTerm {
  virtual ~ForceTerm() = default;
  virtual void add_force(Moment<T>& now) = 0;
};
template <class T> struct DetectionTerm {
  virtual ~DetectionTerm() = default;
  virtual void detect(Moment<T>& now) = 0;
};
template <class T> struct RowsTerm {
  virtual ~RowsTerm() = default;
  virtual void add_rows(Moment<T>& now) = 0;
};
template <class T> struct EventTerm {
  virtual ~EventTerm() = default;
  /// After the step: `next` is its end.
  virtual void after(Moment<T>& now, State<T>& next) = 0;
};

template <class T> struct RestTerm {
  virtual ~RestTerm() = default;
  /// Before anything else: says what rests; whether all does, and the step is nothing.
  virtual bool rests(Moment<T>& now) = 0;
  /// The state is another one.
  virtual void look() = 0;
};

/// Owner of terms: what a row of the table of effects makes.
struct Effect {
  virtual ~Effect() = default;
  [[nodiscard]] virtual Index bytes() const = 0;
};

}  // namespace delassus::simulation
