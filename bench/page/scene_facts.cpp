#include "bench/page/scene_facts.h"

#include <algorithm>
#include <map>

#include "bench/page/drawing.h"
#include "bench/text.h"

namespace delassus::bench {

namespace {

constexpr std::size_t most_drawn = 2000;  // bodies

std::string plural(std::int64_t n, std::string noun) {
  std::replace(noun.begin(), noun.end(), '_', ' ');
  return std::to_string(n) + " " + noun + (n == 1 ? "" : "s");
}

void damping_range(const Damping<double>& damping, SceneResult& out) {
  if (damping.diagonal.empty()) return;
  std::vector<double> values = damping.diagonal;
  for (const auto& block : damping.blocks)
    for (Index i = 0; i < block.R_inverse.rows(); ++i)
      values[static_cast<std::size_t>(block.row + i)] = block.R_inverse(i, i);
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  out.smallest_damping = *low;
  out.largest_damping = *high;
}

}  // namespace

std::string constraint_summary(const Model& model) {
  using Kind = Constraint::Kind;
  std::map<Kind, std::int64_t> count;
  for (const Constraint& c : model.constraints)
    count[c.kind] += c.kind == Kind::joint_friction || c.kind == Kind::joint_lock ? row_count(model, c) : 1;
  std::string text;
  for (const auto& [kind, n] : count) {
    const bool per_row = kind == Kind::joint_friction || kind == Kind::joint_lock;
    text += (text.empty() ? "" : ", ") + plural(n, std::string(name(kind)) + (per_row ? "_row" : ""));
  }
  return text.empty() ? "no constraints" : text;
}

SceneResult facts_of(const Scene& scene, bool with_picture) {
  const auto structure = structure_of(scene.model);
  SceneResult out;
  out.name = scene.name;
  out.summary = constraint_summary(scene.model);
  out.bodies = structure->bodies();
  out.dofs = structure->dofs();
  out.rows = structure->rows;
  out.trees = std::count(structure->parent.begin(), structure->parent.end(), ground);
  out.has_loops = scene.has_loops;
  out.provisional_pose = scene.provisional_pose;
  out.loop_residual = scene.assembly.residual;
  damping_range(scene.damping, out);
  if (with_picture && scene.model.bodies.size() <= most_drawn) out.picture = draw(scene);
  if (!scene.note.empty()) out.notes.push_back(scene.note);
  out.notes.insert(out.notes.end(), scene.notes.begin(), scene.notes.end());
  return out;
}

}  // namespace delassus::bench
