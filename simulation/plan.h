// From a scene to the list of what a step does. Made once: what the scene does not call for is not in the lists, not in memory and
// never executed; what provably vanishes is not called for either (effects.h).
//
// Path     how velocities follow from forces, by what rows there are (paths.h):
//            none                  ABA alone: no Jacobian, no solver
//            equations only        one solve of the pair (ν, λ) by an operator, the ladder unless another is named
//            cones                 a contact problem for a solver; where a step has no such row, one of the above
//          Where there are several trees and any rows, or where something may rest, every island goes its own way (islands_path.h).
#pragma once

#include <memory>
#include <string>
#include <utility>

#include "models/scene.h"
#include "simulation/effects.h"
#include "simulation/cone_path.h"
#include "simulation/terms.h"

namespace delassus::simulation {

struct Settings {
  double step = 1e-3;                                ///< h [s]
  std::vector<std::string> without;                  ///< effects left out though the scene calls for them
  bool everything = false;                           ///< all effects, also those that provably vanish
  const std::vector<EffectRow>* table = &effects();  ///< another table is another program: the tests of absence
  std::string integrator = "euler";                  ///< a row of integrators()
  double error = 0;                                  ///< asked of a second of its steps, which follow it [m, rad, m/s, rad/s]; 0: steps of h
  std::string op = "ladder";                         ///< operator of equations
  double accuracy = 1e-10;                           ///< asked of it: relative, in the energy norm
  std::string solver;                                ///< of cones; empty: usual_solvers(), one after another
  FrictionLaw friction = FrictionLaw::exact;         ///< exact Coulomb, or its convex relaxation, which lifts what slides
  double residual = 1e-10;                           ///< asked of it: natural residual [m/s]
  bool together = false;                             ///< islands in one problem: what solving them apart is held against
};

/// What became of a row of the table.
struct PlanLine {
  const EffectRow* effect;
  Call call;            ///< what the scene says
  bool in = false;      ///< in the plan
  Index bytes = 0;      ///< held by its terms
  std::string terms;    ///< the kinds it contributes
};

template <class T> class Plan {
 public:
  /// @throws ModelError for an effect that does not exist, for a scene whose equations are not satisfied where it starts.
  Plan(const Scene& scene, const Settings& settings);

  double step;                       ///< h [s]
  Model model;                       ///< bodies without armature (an effect brings it), constraints that always hold
  std::vector<Index> constraint_of;  ///< per constraint of `model`: its index in the scene
  Damping<double> damping;           ///< R⁻¹ of its rows
  std::unique_ptr<Mechanism<T>> mechanism;
  std::vector<PlanLine> lines;       ///< one per row of the table, in its order
  std::vector<InertiaTerm<T>*> inertias;
  std::vector<ForceTerm<T>*> forces;
  std::vector<DetectionTerm<T>*> detections;
  std::vector<RowsTerm<T>*> rows;
  std::vector<EventTerm<T>*> events;
  std::vector<RestTerm<T>*> rests;
  std::shared_ptr<Path<T>> path;

  /// For the rows of the table: takes an effect and enters it in the lists of what it is.
  template <class E, class... Arguments> E& add(Arguments&&... arguments) {
    auto owned = std::make_unique<E>(std::forward<Arguments>(arguments)...);
    E& e = *owned;
    enter<InertiaTerm<T>>(&e, inertias, "inertia");
    enter<ForceTerm<T>>(&e, forces, "force");
    enter<DetectionTerm<T>>(&e, detections, "detection");
    enter<RowsTerm<T>>(&e, rows, "rows");
    enter<EventTerm<T>>(&e, events, "event");
    enter<RestTerm<T>>(&e, rests, "rest");
    if (now_ != nullptr) now_->bytes += e.bytes();
    owners_.push_back(std::move(owned));
    return e;
  }
  [[nodiscard]] Index bytes() const;  ///< of all effects

 private:
  template <class Term, class E> void enter(E* e, std::vector<Term*>& list, const char* kind) {
    if constexpr (std::is_base_of_v<Term, E>) {
      list.push_back(e);
      if (now_ != nullptr) now_->terms += (now_->terms.empty() ? "" : ", ") + std::string(kind);
    }
  }
  void take_constraints(const Scene& scene);
  void make_path(const Scene& scene, const Settings& settings);

  std::vector<std::unique_ptr<Effect>> owners_;
  PlanLine* now_ = nullptr;  // the row whose terms are added
};

}  // namespace delassus::simulation
