#include "bench/accuracy/accuracy_subject.h"

#include "bench/text.h"
#include "generators/build.h"
#include "generators/families.h"

namespace delassus::accuracy {

namespace {

/// The root of every body's tree.
std::vector<Index> roots(const Structure& s) {
  std::vector<Index> root(static_cast<std::size_t>(s.bodies()));
  for (Index i = 0; i < s.bodies(); ++i) {
    const Index p = s.parent[static_cast<std::size_t>(i)];
    root[static_cast<std::size_t>(i)] = p == ground ? i : root[static_cast<std::size_t>(p)];
  }
  return root;
}

/// X with (ω, v about the origin) = X (ω, v about p): v + p × ω.
Matrix6<double> motion_transform(const Vector3<double>& p) {
  Matrix6<double> X = Matrix6<double>::Identity();
  X.bottomLeftCorner<3, 3>() = cross_matrix(p);
  return X;
}

void move(Scene& scene, const Vector3<double>& by) {
  for (std::size_t i = 0; i < scene.model.bodies.size(); ++i) {
    Body& body = scene.model.bodies[i];
    if (body.parent != ground) continue;
    if (body.joint.type == JointType::floating) scene.q.segment<3>(scene.model.first_q[i]) += by;
    else body.joint.placement.translation += by;
  }
  for (Constraint& c : scene.model.constraints)
    for (Frame* frame : {&c.a, &c.b})
      if (frame->body == ground) frame->placement.translation += by;
}

}  // namespace

Problem<double> about_origin(const Problem<double>& problem, const std::vector<Vector3<double>>& points) {
  const Structure& s = *problem.structure;
  const std::vector<Index> root = roots(s);
  const auto point = [&](Index body) { return points[static_cast<std::size_t>(root[static_cast<std::size_t>(body)])]; };
  Problem<double> out = problem;
  for (Index i = 0; i < s.bodies(); ++i) {
    const Matrix6<double> X = motion_transform(point(i)), inverse = motion_transform(-point(i));
    for (Index c = s.first_dof[static_cast<std::size_t>(i)]; c < s.first_dof[static_cast<std::size_t>(i) + 1]; ++c)
      out.S[static_cast<std::size_t>(c)] = X * problem.S[static_cast<std::size_t>(c)];
    auto& H = out.H[static_cast<std::size_t>(i)];
    H = inverse.transpose() * H * inverse;
    H = (0.5 * (H + H.transpose())).eval();
  }
  for (const auto& e : s.link_constraints)
    for (const auto& link : e.links) {
      const Matrix6<double> to_force = motion_transform(-point(link.body)).transpose();
      for (Index r = link.first; r < link.first + e.rows; ++r)
        out.K[static_cast<std::size_t>(r)] = to_force * problem.K[static_cast<std::size_t>(r)];
    }
  return out;
}

Subject subject_of(Scene scene, double away) {
  move(scene, {away, 0, 0});
  Subject out{scene.name, true, away, Problem<double>(structure_of(scene.model)), {}, scene.damping};
  Poses<double> poses;
  kinematics(scene.model, scene.q, poses, out.problem);
  out.world = about_origin(out.problem, poses.reference);
  return out;
}

Index middle_size(std::string_view family) {
  const auto& sizes = generators::find_family(family).sizes;
  return sizes[sizes.size() / 2];
}

Subject subject_of(std::string_view family, Index n, std::uint64_t seed, double away) {
  generators::Built built = generators::build(generators::find_family(family).make(n, seed));
  Subject out{std::string(family) + bench::format(" n=%d seed=%d", static_cast<int>(n), static_cast<int>(seed)), false, away,
              std::move(built.problem), {}, std::move(built.damping)};
  const std::vector<Vector3<double>> points(static_cast<std::size_t>(out.problem.structure->bodies()), {away, 0, 0});
  out.world = about_origin(out.problem, points);
  return out;
}

}  // namespace delassus::accuracy
