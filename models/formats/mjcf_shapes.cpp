// Collision geoms: primitives as they are, meshes by MuJoCo's convex hull, ellipsoids by a polyhedron inside them.
#include <algorithm>
#include <cmath>

#include "algorithms/errors/message.h"
#include "models/formats/mjcf_reader.h"

namespace delassus {
namespace {

using Points = std::vector<Vector3<double>>;

Vector3<double> vertex(const mjModel& m, int k) {
  return {double{m.mesh_vert[3 * k]}, double{m.mesh_vert[3 * k + 1]}, double{m.mesh_vert[3 * k + 2]}};
}

/// Points of an ellipsoid on 12 meridians and 7 parallels, and its two ends of z.
Points ellipsoid(const Vector3<double>& half) {
  Points out{{0, 0, half[2]}, {0, 0, -half[2]}};
  for (int i = 1; i < 8; ++i)
    for (int k = 0; k < 12; ++k) {
      const double t = M_PI * i / 8, p = M_PI * k / 6;
      out.push_back({half[0] * std::sin(t) * std::cos(p), half[1] * std::sin(t) * std::sin(p), half[2] * std::cos(t)});
    }
  return out;
}

Vector3<double> extents(const Points& points) {
  Vector3<double> low = points[0], high = points[0];
  for (const auto& p : points) low = low.cwiseMin(p), high = high.cwiseMax(p);
  return (high - low) / 2;
}

}  // namespace

/// A geom that meets nothing by its masks is only drawn.
bool MjcfReader::collides(int g) const { return m_.geom_contype[g] != 0 || m_.geom_conaffinity[g] != 0; }

/// The hull MuJoCo computed for collisions; otherwise all vertices. The box of `size` is about the geom's origin.
bool MjcfReader::fill_mesh(int g, Shape& shape) const {
  const int mesh = m_.geom_dataid[g];
  if (mesh < 0 || m_.mesh_vertnum[mesh] == 0) return false;
  const int first = m_.mesh_vertadr[mesh], graph = m_.mesh_graphadr[mesh];
  Points points;
  if (graph >= 0)
    for (int k = 0; k < m_.mesh_graph[graph]; ++k)
      points.push_back(vertex(m_, first + m_.mesh_graph[graph + 2 + m_.mesh_graph[graph] + k]));
  else
    for (int k = 0; k < m_.mesh_vertnum[mesh]; ++k) points.push_back(vertex(m_, first + k));
  Vector3<double> low = points[0], high = points[0];
  for (const auto& p : points) low = low.cwiseMin(p), high = high.cwiseMax(p);
  const Vector3<double> middle = (low + high) / 2;
  for (auto& p : points) p -= middle;
  shape.placement.translation += shape.placement.rotation * middle;
  shape.size = (high - low) / 2;
  shape.points = std::make_shared<const Points>(std::move(points));
  return true;
}

void MjcfReader::add_shape(int g) {
  const int b = m_.geom_bodyid[g], type = m_.geom_type[g];
  const double* size = m_.geom_size + 3 * g;
  Shape s;
  const Frame at = link_frame(b, mujoco_pose(m_.geom_pos + 3 * g, m_.geom_quat + 4 * g));
  s.placement = at.placement;
  s.friction = m_.geom_condim[g] == 1 ? 0 : m_.geom_friction[3 * g];
  s.size = {size[0], size[1], size[2]};
  const std::string element = "geom " + in_quotes(name(mjOBJ_GEOM, g).empty() ? std::to_string(g) : name(mjOBJ_GEOM, g)) + " of body " + in_quotes(link_name(b));
  switch (type) {
    case mjGEOM_SPHERE: s.kind = Shape::Kind::sphere; break;
    case mjGEOM_CAPSULE: s.kind = Shape::Kind::capsule; break;
    case mjGEOM_CYLINDER: s.kind = Shape::Kind::cylinder; break;
    case mjGEOM_BOX: s.kind = Shape::Kind::box; break;
    case mjGEOM_ELLIPSOID:
      s.kind = Shape::Kind::hull;
      s.points = std::make_shared<const Points>(ellipsoid(s.size));
      s.size = extents(*s.points);
      findings_.note(options_.robot + ": " + element + " is an ellipsoid, taken as a polyhedron of 86 points inside it");
      break;
    case mjGEOM_MESH:
      s.kind = Shape::Kind::hull;
      if (fill_mesh(g, s)) break;
      [[fallthrough]];
    default:
      findings_.warn("shape without contacts", options_.file, element, "a shape of this kind is left out", "spheres, capsules, cylinders, boxes, ellipsoids, meshes");
      return;
  }
  if (at.body == ground) out_.standing.push_back({options_.robot + "/" + link_name(b), std::move(s)});
  else bodies_.body(at.body).shapes.push_back(std::move(s));
}

void MjcfReader::add_shapes() {
  int drawn = 0, planes = 0;
  for (int g = 0; g < m_.ngeom; ++g) {
    if (!collides(g)) ++drawn;
    else if (m_.geom_type[g] == mjGEOM_PLANE && link_[static_cast<std::size_t>(m_.geom_bodyid[g])].body == ground) ++planes;
    else add_shape(g);
  }
  const auto say = [&](int n, const char* what) {
    if (n > 0) findings_.note(options_.robot + ": " + std::to_string(n) + " " + what);
  };
  say(drawn, "geom(s) that touch nothing (contype and conaffinity 0) are left out");
  say(planes, "plane(s) of the file are left out; contacts are with `ground:` of the scene");
}

}  // namespace delassus
