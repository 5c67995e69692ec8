#include "simulation/step.h"

#include <cmath>

#include "algorithms/errors/message.h"
#include "algorithms/kit/counted.h"

namespace delassus::simulation {
namespace {

/// Names the effects that bring rows.
template <class T> [[noreturn]] void refuse_rows(const Scene& scene, const Plan<T>& plan, const IntegratorRow& integrator) {
  std::string brings;
  for (const PlanLine& line : plan.lines)
    if (line.in && line.terms.find("rows") != std::string::npos) brings += (brings.empty() ? "" : ", ") + std::string(line.effect->name);
  throw ModelError(scene.file, "integrator " + std::string(integrator.name), "steps no scene with rows, which are brought by: " + brings,
                   "euler, or a scene without them; --without leaves an effect out");
}

}  // namespace

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
  const IntegratorRow& integrator = find_integrator(settings.integrator);
  if (!integrator.rows && (plan_.mechanism->structure()->rows > 0 || !plan_.rows.empty())) refuse_rows(scene, plan_, integrator);
  if (integrator.order == 1) return;
  stages_ = std::make_unique<RungeKutta<T>>(plan_.model);
  now_.h = T(0), now_.weight = T(1);
  take_ = &Simulation::runge_kutta;
}

template <class T> void Simulation<T>::restore(const State<T>& state) {
  require(state.q.size() == state_.q.size() && state.nu.size() == state_.nu.size(), "Simulation: the state is another model's");
  state_ = state;
}

template <class T> void Simulation<T>::gather() {
  plan_.mechanism->update(now_.state->q);
  plan_.mechanism->fill(problem_);
  now_.start();
  for (auto* term : plan_.detections) term->detect(now_);
  for (auto* term : plan_.inertias) term->add_inertia(now_);
  for (auto* term : plan_.forces) term->add_force(now_);
  for (auto* term : plan_.rows) term->add_rows(now_);
}

template <class T> const StepReport& Simulation<T>::euler() {
  now_.state = &state_;
  gather();
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

template <class T> const StepReport& Simulation<T>::runge_kutta() {
  (*stages_)(T(settings_.step), state_, [&](const State<T>& at, VectorX<T>& acceleration) {
    now_.state = &at;
    gather();
    report_ = plan_.path->velocities(now_, acceleration, impulses_);
    return report_.ok();
  });
  return report_;
}

template class Simulation<double>;
template class Simulation<Counted>;

}  // namespace delassus::simulation
