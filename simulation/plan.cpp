#include "simulation/plan.h"

#include <algorithm>

#include "algorithms/errors/message.h"
#include "algorithms/kit/counted.h"
#include "algorithms/mechanism/loop_closing.h"
#include "simulation/closing.h"
#include "simulation/islands_path.h"

namespace delassus::simulation {
namespace {

/// The scene's R⁻¹ of some of its constraints.
void take_damping(const Scene& scene, const std::vector<Index>& kept, Damping<double>& out) {
  std::vector<Index> first{0};
  for (const Constraint& c : scene.model.constraints) first.push_back(first.back() + row_count(scene.model, c));
  for (const Index k : kept) {
    const Index begin = first[static_cast<std::size_t>(k)], end = first[static_cast<std::size_t>(k) + 1], to = static_cast<Index>(out.diagonal.size());
    for (Index r = begin; r < end; ++r) {
      const auto row = static_cast<std::size_t>(r);
      out.diagonal.push_back(row < scene.damping.diagonal.size() ? scene.damping.diagonal[row] : 0);
    }
    for (const auto& block : scene.damping.blocks)
      if (block.row >= begin && block.row < end) out.blocks.push_back({block.row - begin + to, block.R_inverse});
  }
}

/// Equations that do not hold where the scene starts would be closed by a jump.
template <class T> void check_closed(const Scene& scene, const Plan<T>& plan) {
  Poses<double> at;
  poses(plan.model, scene.q, at);
  for (const Constraint& c : plan.model.constraints) {
    const VectorX<double> e = closure_error(plan.model, c, at);
    const double open = e.size() > 0 ? e.cwiseAbs().maxCoeff() : 0, accepted = std::max(c.tolerance, 1e-3);
    if (!(open <= accepted))
      throw ModelError(scene.file, std::string(name(c.kind)) + " constraint " + in_quotes(c.name), "is open by " + number_text(open) + " m or rad at the start",
                       "constraints that hold at the start, to " + number_text(accepted) + " m and rad; loop: true closes it, without to_at and to_axes it holds what the pose has");
  }
}

}  // namespace

template <class T> Plan<T>::Plan(const Scene& scene, const Settings& settings) : step(settings.step) {
  const std::vector<EffectRow>& table = *settings.table;
  for (const std::string& name : settings.without) (void)find_effect(name, table);
  for (const EffectRow& row : table) {
    const bool left_out = std::find(settings.without.begin(), settings.without.end(), row.name) != settings.without.end();
    PlanLine line{&row, row.call(scene), false, 0, ""};
    line.in = !left_out && (line.call.called || settings.everything);
    if (left_out && line.call.called) line.call.why += "; left out";
    lines.push_back(std::move(line));
  }
  for (PlanLine& line : lines) {
    const std::string_view needs = line.effect->needs;
    const auto there = [&](const PlanLine& l) { return l.in && l.effect->name == needs; };
    if (!line.in || needs.empty() || std::any_of(lines.begin(), lines.end(), there)) continue;
    line.in = false;
    line.call.why += "; nothing to act on without " + std::string(needs);
  }
  take_constraints(scene);
  mechanism = std::make_unique<Mechanism<T>>(model);
  for (PlanLine& line : lines) {
    now_ = &line;
    const auto adder = std::get<Adder<T>>(line.effect->adders);
    if (line.in && adder != nullptr) adder(*this, scene);
  }
  now_ = nullptr;
  make_path(scene, settings);
}

/// The path by what rows there may be, and what closes the drift of those that always hold.
template <class T> void Plan<T>::make_path(const Scene& scene, const Settings& settings) {
  using Way = std::shared_ptr<Path<T>>;
  using Equations = std::shared_ptr<EquationsPath<T>>;
  const auto structure = mechanism->structure();
  const bool cones = !rows.empty();
  const auto equations_of = [&](const std::shared_ptr<const Structure>& s, const Damping<double>& d) {
    return std::make_shared<EquationsPath<T>>(s, d.template cast<T>(), settings.op, settings.accuracy);
  };
  const auto way = [cones, solver = settings.solver, residual = settings.residual, law = settings.friction](
                       const std::shared_ptr<const Structure>& s, const Damping<double>& d, const Equations& equations, const std::vector<Index>& numbers) -> Way {
    if (cones) return std::make_shared<ConePath<T>>(s, d, equations, solver, residual, law, numbers);
    if (equations) return equations;
    return std::make_shared<FreePath<T>>(s);
  };
  std::vector<ClosedTogether<T>> loops;
  if (!rests.empty() || (!settings.together && Islands(*structure).trees() > 1 && (cones || structure->rows > 0))) {
    auto islands = std::make_shared<IslandsPath<T>>(cones ? "cones" : structure->rows > 0 ? "equations" : "free", structure, damping, way, equations_of);
    for (const auto& l : islands->loops()) loops.push_back({l.path.get(), l.part.bodies, l.part.rows});
    path = std::move(islands);
  } else {
    Equations equations;
    if (structure->rows > 0) {
      equations = equations_of(structure, damping);
      loops.push_back(all_of(model, *equations));
    }
    path = way(structure, damping, equations, {});
  }
  const auto closes = [](const Constraint& c) { return c.kind != Constraint::Kind::coupling && c.kind != Constraint::Kind::general && !acts_on_joint(c.kind); };
  if (std::none_of(model.constraints.begin(), model.constraints.end(), closes)) return;
  check_closed(scene, *this);
  add<Closing<T>>(model, *mechanism, std::move(loops));
}

/// Bodies, and the constraints of the effects that are in, in the order of the scene.
template <class T> void Plan<T>::take_constraints(const Scene& scene) {
  model = scene.model;
  for (Body& b : model.bodies) b.joint.armature.clear();
  model.constraints.clear();
  for (std::size_t k = 0; k < scene.model.constraints.size(); ++k) {
    const Constraint& c = scene.model.constraints[k];
    for (PlanLine& line : lines) {
      if (!line.in || line.effect->holds == nullptr || !line.effect->holds(c)) continue;
      model.constraints.push_back(c);
      constraint_of.push_back(static_cast<Index>(k));
      const Index rows_of = row_count(model, c);
      line.bytes += rows_of * 12 * static_cast<Index>(sizeof(T));  // K of two bodies
      if (line.terms.empty()) line.terms = "rows";
    }
  }
  take_damping(scene, constraint_of, damping);
}

template <class T> Index Plan<T>::bytes() const {
  Index sum = 0;
  for (const PlanLine& line : lines) sum += line.bytes;
  return sum;
}

template class Plan<double>;
template class Plan<Counted>;

}  // namespace delassus::simulation
