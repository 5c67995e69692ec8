// Drift: what a step leaves open of the constraints that have a position, closed after it.
//
//   q ← q ⊕ d,   min ‖d‖_M̂  with  J d = −φ(q)
// How      chord steps with J and M̂ of the step that has just been taken: no new factor; φ falls from order h² by a factor of order h
//          each time. Where it no longer halves rows that depend on each other give way (yielding.h). Ends at 1e-12 m and rad, when φ
//          does not halve for all that, or after six; trees that no row joins end apart. Velocities
//          are not touched, so closing gives no energy but that of the displacement d in the fields.
// Cost     a solve and the poses, two or three times as a rule.
#pragma once

#include "simulation/paths.h"

namespace delassus::simulation {

/// Equations that have one end: the path with their factor, the bodies and rows of the model that it is of, ascending.
template <class T> struct ClosedTogether {
  EquationsPath<T>* path;
  std::vector<Index> bodies, rows;
};
/// All of a model.
template <class T> [[nodiscard]] ClosedTogether<T> all_of(const Model& model, EquationsPath<T>& path);

template <class T> class Closing final : public Effect, public EventTerm<T> {
 public:
  static constexpr double closed = 1e-12;  ///< [m, rad]

  Closing(const Model& model, Mechanism<T>& mechanism, std::vector<ClosedTogether<T>> loops);
  void after(Moment<T>& now, State<T>& next) override;
  [[nodiscard]] Index bytes() const override;

 private:
  struct Loop {
    ClosedTogether<T> of;
    Advance<T> advance;
    T open, then;  // largest |φ|, and after the next displacement
    bool ends, moved;
  };
  /// Largest |φ| at q of each loop; leaves φ in `gap`.
  void measure(const VectorX<T>& q, VectorX<T>& gap, T Loop::*largest);
  void displace(Loop& loop);
  void keep(Loop& loop, VectorX<T>& q);
  const Model* model_;
  Mechanism<T>* mechanism_;
  std::vector<Loop> loops_;
  Poses<T> poses_;
  VectorX<T> gap_, gap_then_, gap_of_, d_, q_;
};

}  // namespace delassus::simulation
