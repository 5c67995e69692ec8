#include "simulation/step.h"

#include <algorithm>
#include <cmath>

#include "algorithms/errors/message.h"
#include "algorithms/kit/counted.h"

namespace delassus::simulation {
namespace {

/// Rows in cones and sleep, by the names of the effects that bring them, and rows that give way: explicit methods take neither.
template <class T> void check_rows(const Scene& scene, const Plan<T>& plan, const IntegratorRow& integrator) {
  std::string brings;
  for (const PlanLine& line : plan.lines)
    if (line.in && line.effect->holds == nullptr && (line.terms.find("rows") != std::string::npos || line.terms.find("rest") != std::string::npos)) brings += (brings.empty() ? "" : ", ") + std::string(line.effect->name);
  if (!brings.empty() && integrator.takes != Takes::cones)
    throw ModelError(scene.file, "integrator " + std::string(integrator.name), "steps no scene with rows in cones or sleep, which are brought by: " + brings,
                     "euler, without an accuracy of its steps; or a scene without them: --without leaves an effect out");
  if (integrator.takes == Takes::cones) return;
  const auto soft = std::find_if(plan.damping.diagonal.begin(), plan.damping.diagonal.end(), [](double x) { return x != 0; });
  if (soft != plan.damping.diagonal.end() || !plan.damping.blocks.empty())
    throw ModelError(scene.file, "integrator " + std::string(integrator.name), "steps hard rows only, and damping is above 0",
                     "damping: 0 in the scene; or euler, without an accuracy of its steps");
}

[[noreturn]] void refuse_error(const Scene& scene, const Settings& settings) {
  if (!(std::isfinite(settings.error) && settings.error > 0))
    throw ModelError(scene.file, "accuracy", number_text(settings.error) + " a second", "a finite number > 0 [m, rad, m/s, rad/s]");
  throw ModelError(scene.file, "integrator " + settings.integrator, "has steps of one length, and an accuracy is asked of them", "dormand_prince, or sdirk4 for stiff springs; or a step, without an accuracy");
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
  check_rows(scene, plan_, integrator);
  if (settings.error != 0 && !(integrator.controlled && std::isfinite(settings.error) && settings.error > 0)) refuse_error(scene, settings);
  if (integrator.tableau == nullptr) return;
  now_.h = now_.ahead = T(0), now_.weight = T(1);
  acceleration_ = [this](const State<T>& at, const Stage& stage, VectorX<T>& out) { return accelerations(at, stage, out); };
  if (integrator.tableau->implicit()) {
    acceleration_ = [this](const State<T>& at, const Stage& stage, VectorX<T>& out) { return implicit_accelerations(at, stage, out); };
    now_.start();
    for (auto* term : plan_.inertias) term->add_inertia(now_);
    armature_ = problem_.armature;
  }
  if (plan_.mechanism->structure()->rows > 0) constrained_ = std::make_unique<Constrained<T>>(plan_.model, *plan_.mechanism, settings.op, settings.accuracy);
  if (settings.error > 0) {
    control_ = std::make_unique<ErrorControl<T>>(plan_.model, *integrator.tableau, settings.error);
    take_ = &Simulation::controlled;
  } else {
    stages_ = std::make_unique<RungeKutta<T>>(plan_.model, *integrator.tableau);
    take_ = &Simulation::runge_kutta;
  }
}

template <class T> void Simulation<T>::restore(const State<T>& state) {
  require(state.q.size() == state_.q.size() && state.nu.size() == state_.nu.size(), "Simulation: the state is another model's");
  require(state.rest.empty() || plan_.rests.empty() || state.rest_force.size() == state_.nu.size(), "Simulation: the state is another model's");
  state_ = state;
  for (auto* term : plan_.rests) term->look();
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

/// A step in which nothing moves.
template <class T> const StepReport& Simulation<T>::still() {
  rows_.clear();
  impulses_.resize(0);
  change_.setConstant(T(0));
  report_ = {};
  report_.path = "asleep";
  ++state_.steps;
  return report_;
}

template <class T> const StepReport& Simulation<T>::euler() {
  now_.state = &state_;
  for (auto* term : plan_.rests)
    if (term->rests(now_)) return still();
  gather();
  report_ = plan_.path->velocities(now_, change_, impulses_);
  if (!report_.ok()) return report_;
  next_.q = state_.q, next_.nu = state_.nu + change_;  // impulses are remembered anew
  next_.steps = state_.steps + 1, next_.trial = state_.trial;
  if (!plan_.rests.empty()) next_.rest.swap(state_.rest), next_.rest_force.swap(state_.rest_force);  // nothing fails from here on
  plan_.path->remember(now_, next_);
  advance_(now_.h, next_.q, next_.nu);
  for (auto* term : plan_.events) term->after(now_, next_);
  report_.drift = now_.drift, report_.left = now_.left;
  std::swap(state_, next_);
  return report_;
}

template <class T> bool Simulation<T>::accelerations(const State<T>& at, const Stage&, VectorX<T>& out) {
  now_.state = &at;
  gather();
  return solve_accelerations(out);
}

/// M̂ a⁺ − Jᵀλ = f + (M̂ − M) a of an implicit stage: M̂ − M is the diagonal of what is implicit.
template <class T> bool Simulation<T>::implicit_accelerations(const State<T>& at, const Stage& stage, VectorX<T>& a) {
  now_.state = &at;
  now_.h = stage.g, now_.again = stage.again;
  gather();
  for (std::size_t k = 0; k < armature_.size(); ++k) force_[static_cast<Index>(k)] += (problem_.armature[k] - armature_[k]) * a[static_cast<Index>(k)];
  return solve_accelerations(a);
}

template <class T> bool Simulation<T>::solve_accelerations(VectorX<T>& out) {
  if (!constrained_) {
    report_ = plan_.path->velocities(now_, out, impulses_);
    return report_.ok();
  }
  report_ = {};
  report_.path = plan_.path->name();
  report_.rows = plan_.mechanism->structure()->rows;
  report_.report = constrained_->accelerations(now_, out, impulses_);
  return report_.ok();
}

/// Back onto the rows; the state goes on from there.
template <class T> bool Simulation<T>::end_at(State<T>& next) {
  if (constrained_) {
    now_.state = &next;
    gather();
    report_.report = constrained_->project(now_, next);
    report_.drift = now_.drift, report_.left = now_.left;
    if (!report_.ok()) return false;
  }
  ++next.steps;
  std::swap(state_, next);
  return true;
}

template <class T> const StepReport& Simulation<T>::runge_kutta() {
  stages_->start(state_);
  if (!stages_->attempt(T(settings_.step), acceleration_)) return ended_at_stage();
  next_ = state_;
  stages_->accept(next_);
  (void)end_at(next_);
  report_.iterations = stages_->iterations(), report_.residual = static_cast<double>(stages_->left());
  return report_;
}

/// An evaluation failed, or an implicit stage did not converge: then it may have gone where nothing can be evaluated.
template <class T> const StepReport& Simulation<T>::ended_at_stage() {
  if (stages_->iterations() == 0) return report_;
  const std::string status = report_.ok() ? "" : ", an evaluation ended with " + std::string(name(report_.report.status));
  report_.report.status = Status::not_converged;
  report_.iterations = stages_->iterations(), report_.residual = static_cast<double>(stages_->change());
  report_.message = "stage " + std::to_string(stages_->stage() + 1) + " of " + settings_.integrator + " does not converge: the last of " + std::to_string(report_.iterations) +
                    " iterations changes velocities by " + number_text(report_.residual) + " of the largest (or of 1 m/s or rad/s), " + number_text(RungeKutta<T>::within) +
                    " are accepted" + status + "; a smaller step than " + number_text(settings_.step) + " s: the scene turns too far in it, or a motor jumps to its effort and back";
  return report_;
}

template <class T> const StepReport& Simulation<T>::controlled() {
  using End = typename ErrorControl<T>::End;
  next_ = state_;
  const End end = (*control_)(T(settings_.step), next_, acceleration_);
  const auto& spent = control_->spent();
  report_.taken = spent.taken, report_.rejected = spent.rejected, report_.error = spent.error;
  if (end == End::reached) (void)end_at(next_);
  report_.iterations = spent.iterations, report_.residual = spent.left;
  if (end != End::too_short) return report_;
  report_.report.status = Status::not_converged;
  report_.message = "an accuracy of " + number_text(settings_.error) + " a second is not reached by steps of " +
                    number_text(ErrorControl<T>::shortest * settings_.step) + " s: it is within rounding, or the motion is not smooth; a larger one";
  return report_;
}

template class Simulation<double>;
template class Simulation<Counted>;

}  // namespace delassus::simulation
