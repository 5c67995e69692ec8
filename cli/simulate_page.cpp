#include "cli/simulate_page.h"

#include <fstream>

#include <Eigen/Geometry>

#include "bench/text.h"
#include "cli/common.h"
#include "cli/player.h"

namespace delassus::cli {

namespace {

double rounded(double x) { return std::round(x * 1e5) / 1e5; }

json shape_json(const Shape& s, Index body) {
  constexpr const char* kinds[] = {"sphere", "cylinder", "capsule", "box", "hull"};
  const Eigen::Quaterniond r(s.placement.rotation);
  json out = {{"body", body}, {"kind", kinds[static_cast<int>(s.kind)]}, {"size", {s.size[0], s.size[1], s.size[2]}},
              {"at", {s.placement.translation[0], s.placement.translation[1], s.placement.translation[2], r.w(), r.x(), r.y(), r.z()}}};
  if (s.kind == Shape::Kind::hull && s.points) {
    out["points"] = json::array();
    for (const auto& p : *s.points) out["points"].push_back({rounded(p[0]), rounded(p[1]), rounded(p[2])});
  }
  return out;
}

json scene_json(const Scene& scene, double step) {
  json out = {{"name", scene.name}, {"step", step}, {"ground", scene.has_ground ? json(scene.ground_height) : json(nullptr)},
              {"parents", json::array()}, {"bodies", json::array()}, {"shapes", json::array()}, {"effects", json::array()}};
  double weight = 0;
  for (std::size_t i = 0; i < scene.model.bodies.size(); ++i) {
    const Body& b = scene.model.bodies[i];
    out["parents"].push_back(b.parent);
    out["bodies"].push_back(b.name);
    weight += b.mass * scene.gravity.norm();
    for (const Shape& s : b.shapes) out["shapes"].push_back(shape_json(s, static_cast<Index>(i)));
  }
  for (const Standing& s : scene.motion.search.standing) out["shapes"].push_back(shape_json(s.shape, ground));
  out["weight"] = weight;
  for (const auto& e : simulation::effects())
    if (e.call(scene).called) out["effects"].push_back(e.name);
  return out;
}

json frame_json(const Frame3D& f) {
  const auto list = [](const std::vector<double>& x) {
    json out = json::array();
    for (const double v : x) out.push_back(rounded(v));
    return out;
  };
  return {{"t", f.time}, {"p", list(f.poses)}, {"c", list(f.forces)}, {"k", f.kinetic}, {"u", f.potential}, {"r", f.rows}, {"i", f.iterations}, {"e", f.residual}, {"d", f.drift}};
}

}  // namespace

Frame3D frame_of(const Scene& scene, const simulation::Simulation<double>& s, const simulation::Observed<double>& o) {
  Frame3D out;
  Poses<double> at;
  poses(scene.model, s.state().q, at);
  out.time = s.time(), out.kinetic = o.kinetic, out.potential = o.potential;
  const auto& r = s.last();
  out.residual = r.residual, out.drift = r.drift, out.rows = r.rows, out.iterations = r.iterations;
  for (std::size_t i = 0; i < scene.model.bodies.size(); ++i) {
    const Pose<double> x = world_pose(at, static_cast<Index>(i));
    const Eigen::Quaterniond q(x.rotation);
    out.poses.insert(out.poses.end(), {x.translation[0], x.translation[1], x.translation[2], q.w(), q.x(), q.y(), q.z()});
  }
  if (s.impulses().size() == 0) return out;
  Index row = s.problem().structure->rows;
  for (const auto& c : s.rows()) {
    if (c.kind == simulation::RowSet<double>::Kind::contact && s.impulses()[row] > 0) {
      Vector3<double> f = Vector3<double>::Zero();
      for (Index k = 0; k < c.directions; ++k)
        if (!c.row(k).spins) f += s.impulses()[row + k] / s.settings().step * c.axes.col(c.row(k).axis);
      const Vector3<double> x = at.reference[static_cast<std::size_t>(at.tree[static_cast<std::size_t>(c.body)])] + c.point;
      out.forces.insert(out.forces.end(), {x[0], x[1], x[2], f[0], f[1], f[2]});
    }
    row += c.directions;
  }
  return out;
}

void write_page(const std::string& file, const Scene& scene, double step, const std::vector<Frame3D>& frames) {
  json data = scene_json(scene, step);
  data["frames"] = json::array();
  for (const Frame3D& f : frames) data["frames"].push_back(frame_json(f));
  std::string text = data.dump();
  for (std::size_t at = text.find("</"); at != std::string::npos; at = text.find("</", at + 3)) text.replace(at, 2, "<\\/");  // names end no script
  std::ofstream out(file);
  out << player_begin << "<title>" << bench::escape(scene.name) << "</title>" << player_body << "<script>const data = " << text << ";</script>\n" << player_end;
  if (!out.flush()) throw ModelError(file, "--record", "cannot be written", "a .html file in a folder that exists; make room, or the folder first");
}

}  // namespace delassus::cli
