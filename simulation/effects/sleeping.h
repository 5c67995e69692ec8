// Sleeping: what has been at rest for a while is not moved, until something happens to it.
//
//   quiet     a tree whose bodies have ‖v‖ ≤ linear at the origins of their frames and ‖ω‖ ≤ angular
//   falls     an island whose trees have all been quiet for `after`: its ν becomes 0, its impulses are kept for a warm start
//   asleep    q stays bit for bit, no row, no factor, no solver; with everything asleep a step is nothing at all. While others are
//             awake, frames are still computed, and contacts of what sleeps with what is awake looked for
//   wakes     the island, where a row joins it to something awake, or where the force on it is, in any bit, not that of its first
//             step asleep: another wrench or motor, in a scene that goes on from the state
// Energy   dissipates: what falls asleep loses its kinetic energy, at most Σ ½ m v² + ½ ωᵀIω at the two thresholds, once.
// Bits     of what is awake are those of a scene without what sleeps (islands_path.h). All of it is in the state: a saved one goes on.
// Cost     20 operations a body, 2 a degree of freedom.
#pragma once

#include "algorithms/kit/six.h"
#include "models/scene.h"
#include "simulation/terms.h"

namespace delassus::simulation {

template <class T> class Sleeping final : public Effect, public RestTerm<T>, public DetectionTerm<T>, public ForceTerm<T>, public EventTerm<T> {
 public:
  /// `detections`: all of the plan, this one last; they look again when something wakes.
  Sleeping(const Model& model, const SceneMotion::Sleeping& limits, double step, const std::vector<DetectionTerm<T>*>& detections);
  bool rests(Moment<T>& now) override;
  void look() override { looked_ = false; }
  void detect(Moment<T>& now) override;
  void add_force(Moment<T>& now) override;
  void after(Moment<T>& now, State<T>& next) override;
  [[nodiscard]] Index bytes() const override;

 private:
  struct Range {
    Index first, end;
  };
  [[nodiscard]] Index label_of(Index body) const { return label_[static_cast<std::size_t>(tree_[static_cast<std::size_t>(body)])]; }
  void wake(Index label);
  [[nodiscard]] bool touched(const Moment<T>& now);
  void look_again(Moment<T>& now);
  void measure(Moment<T>& now, const VectorX<T>& nu);
  void fall(State<T>& next, const std::vector<Index>& island);
  void stay(const Moment<T>& now, State<T>& next, std::size_t tree) const;

  double linear_, angular_;
  std::int64_t steps_;                           // of quiet
  const std::vector<DetectionTerm<T>*>* detections_;
  std::vector<Index> tree_;                      // per body
  std::vector<std::vector<Range>> dofs_;         // per tree
  std::vector<Index> label_;                     // per tree: the island it sleeps in, −1 awake
  std::vector<std::uint8_t> resting_;            // per body, where one sleeps
  std::vector<std::uint8_t> quiet_, falls_;      // per tree; per island, by its first tree
  std::vector<Six<T>> speeds_;                   // per body, where its tree may be quiet
  bool looked_ = false, any_ = false;            // at this state; something sleeps, or may
};

}  // namespace delassus::simulation
