// `delassus export SCENE`: the numeric problem and the dense matrices of its definition, as JSON.
#include <cstdio>
#include <fstream>

#include "cli/commands.h"
#include "cli/common.h"
#include "reference/definition.h"
#include "cli/program/options.h"

namespace delassus::cli {

namespace {

template <class Vector> json vector_json(const Vector& v) { return std::vector<double>(v.begin(), v.end()); }

json joints_json(const Model& model) {
  json joints = json::array();
  for (std::size_t i = 0; i < model.bodies.size(); ++i) {
    const Body& b = model.bodies[i];
    joints.push_back({{"body", b.name}, {"joint", b.joint.name}, {"type", name(b.joint.type)},
                      {"first_dof", model.first_dof[i]}, {"dof", dof_count(b.joint.type)}});
  }
  return joints;
}

/// K_e^i of every constraint on links.
void add_link_constraints(const Problem<double>& p, json& out) {
  for (const auto& e : p.structure->link_constraints) {
    json links = json::array();
    for (const auto& end : e.links) {
      json K = json::array();
      for (Index r = 0; r < e.rows; ++r) K.push_back(vector_json(p.K[static_cast<std::size_t>(end.first + r)]));
      links.push_back({{"body", end.body}, {"K", K}});
    }
    out.push_back({{"row", e.row}, {"rows", e.rows}, {"links", links}});
  }
}

/// 𝒦_i of every constraint on a joint.
void add_joint_constraints(const Problem<double>& p, json& out) {
  for (const auto& e : p.structure->joint_constraints) {
    const Index n = p.structure->dofs(e.body);
    const Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>> K(
        p.joint_K.data() + e.first, e.rows, n);
    out.push_back({{"row", e.row}, {"rows", e.rows}, {"joint_of_body", e.body}, {"K", matrix_json(K)}});
  }
}

json problem_json(const Scene& scene) {
  const Problem<double> p = problem_of(scene);
  json S = json::array(), H = json::array(), constraints = json::array();
  for (const auto& column : p.S) S.push_back(vector_json(column));
  for (const auto& inertia : p.H) H.push_back(matrix_json(inertia));
  add_link_constraints(p, constraints);
  add_joint_constraints(p, constraints);
  std::sort(constraints.begin(), constraints.end(), [](const json& a, const json& b) { return a["row"] < b["row"]; });
  return {{"scene", scene.name},
          {"conventions", "SI units; spatial vectors angular part first, world axes, about the reference point of the body's "
                          "tree (centre of mass of its root body); S: one 6-vector per degree of freedom; H: spatial inertia "
                          "per body; parent -1 is the ground; rows of J and R_inverse in the order of `constraints`"},
          {"dof", p.structure->dofs()}, {"rows", p.structure->rows}, {"parents", p.structure->parent},
          {"joints", joints_json(scene.model)}, {"q", vector_json(scene.q)}, {"armature", p.armature}, {"S", S}, {"H", H},
          {"constraints", constraints}, {"M", matrix_json(reference::mass_matrix(p))},
          {"J", matrix_json(reference::constraint_jacobian(p))},
          {"R_inverse", matrix_json(reference::damping_matrix(*p.structure, scene.damping))},
          {"warnings", warnings_json(scene)}};
}

int export_scene(const std::string& name, const SceneOptions& opening, const std::string& file) {
  const std::string text = problem_json(open(name, opening)).dump();
  if (file.empty()) {
    std::printf("%s\n", text.c_str());
    return good;
  }
  std::ofstream out(file);
  out << text << '\n';
  if (!out.flush()) throw ModelError(file, "file", "cannot be written", "a path with write permission; make its folder first, or leave --out away");
  return good;
}

}  // namespace

void add_export(options::Command& app, Run& run) {
  options::Command* c = app.add_subcommand("export", "the numeric problem and dense M, J, R⁻¹ as JSON, for others to check");
  auto scene = std::make_shared<std::string>(), file = std::make_shared<std::string>();
  c->add_option("scene", *scene, "name, .yaml file, robot's file (URDF) or swimmer:N")->required();
  auto opening = std::make_shared<SceneOptions>();
  add_scene_options(*c, *opening);
  c->add_option("--out", *file, "file to write instead of standard output");
  c->footer("Numbers are printed with as many digits (up to 17) as reading them back exactly needs.");
  c->callback([=, &run] { run = [=] { return export_scene(*scene, *opening, *file); }; });
}

}  // namespace delassus::cli
