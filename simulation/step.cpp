#include "simulation/step.h"

#include <cmath>

#include "algorithms/errors/message.h"
#include "algorithms/kit/counted.h"

namespace delassus::simulation {

template <class T>
Simulation<T>::Simulation(const Scene& scene, const Settings& settings)
    : settings_(settings), plan_(scene, settings), advance_(plan_.model), problem_(plan_.mechanism->structure()), now_(plan_.model, *plan_.mechanism, T(settings.step)) {
  if (!(std::isfinite(settings.step) && settings.step > 0))
    throw ModelError(scene.file, "step", number_text(settings.step) + " s", "a finite number > 0 [s]; 1e-3 is a usual one");
  state_.q = scene.q.cast<T>();
  state_.nu = scene.motion.nu.size() > 0 ? VectorX<T>(scene.motion.nu.cast<T>()) : VectorX<T>::Constant(plan_.model.dofs(), T(0));
  require(state_.q.size() == plan_.model.q_size() && state_.nu.size() == plan_.model.dofs(), "Simulation: q or ν of the scene do not fit its model");
  force_ = VectorX<T>::Constant(plan_.model.dofs(), T(0));
  now_.state = &state_;
  now_.problem = &problem_;
  now_.force = &force_;
  now_.rows = &rows_;
}

template <class T> void Simulation<T>::restore(const State<T>& state) {
  require(state.q.size() == state_.q.size() && state.nu.size() == state_.nu.size(), "Simulation: the state is another model's");
  state_ = state;
}

template <class T> const StepReport& Simulation<T>::step() {
  plan_.mechanism->update(state_.q);
  plan_.mechanism->fill(problem_);
  now_.start();
  for (auto* term : plan_.detections) term->detect(now_);
  for (auto* term : plan_.inertias) term->add_inertia(now_);
  for (auto* term : plan_.forces) term->add_force(now_);
  for (auto* term : plan_.rows) term->add_rows(now_);
  report_ = plan_.path->velocities(now_, change_, impulses_);
  if (!report_.ok()) return report_;
  next_ = state_;
  next_.nu += change_;
  ++next_.steps;
  plan_.path->remember(now_, next_);
  advance_(now_.h, next_.q, next_.nu);
  for (auto* term : plan_.events) term->after(now_, next_);
  report_.drift = now_.drift, report_.left = now_.left;
  std::swap(state_, next_);
  return report_;
}

template class Simulation<double>;
template class Simulation<Counted>;

}  // namespace delassus::simulation
