#include <algorithm>
#include <array>

#include <Eigen/Eigenvalues>

#include "algorithms/errors/closest.h"
#include "algorithms/errors/message.h"
#include "models/shapes/between.h"
#include "models/shapes/mesh.h"
#include "models/scene_loader.h"

namespace delassus {
/// {of, at, to, normal, friction}: the point is given in the link's frame, the normal in world axes.
void SceneLoader::read_contact(const Yaml& y, double friction) {
  y.keys({"name", "of", "at", "to", "normal", "friction", "damping"});
  const End a = end_of(y.at("of")), b = y.has("to") ? end_of(y.at("to")) : End{{}, "ground"};
  if (a.frame.body == b.frame.body) y.fail(in_quotes(a.name) + " and " + in_quotes(b.name) + " are one body", "two different bodies, or one and ground; links joined by fixed joints are one body");
  if (b.name == "ground" && !y.has("normal") && !scene_.has_ground) y.fail("the scene has no ground", "ground: {z: ...}, or normal: [x, y, z]; give one of them");
  Vector3<double> normal(0, 0, 1);
  if (y.has("normal")) normal = y.at("normal").direction();
  else if (b.frame.body != ground) y.fail("key normal is missing", "normal: [x, y, z] in world axes; it points from `to` to `of`");
  const Vector3<double> at = y.has("at") ? y.at("at").vector3(" [m]") : Vector3<double>(0, 0, 0);
  Constraint c;
  c.kind = Constraint::Kind::contact;
  c.name = "contact " + a.name + " - " + b.name;
  c.a.body = a.frame.body;
  c.a.placement = {world_pose(poses_, a.frame.body).rotation.transpose() * frame_about(normal), a.frame.placement * at};
  c.b = {b.frame.body, relative_pose(poses_, b.frame.body, a.frame.body) * c.a.placement};
  c.friction = y.has("friction") ? y.at("friction").non_negative("") : b.frame.body == ground ? friction : -1;
  add(y, std::move(c));
}

/// From the first-th on, of the object.
void SceneLoader::stand(const std::vector<Standing>& shapes, std::size_t first, Index object) {
  for (std::size_t k = first; k < shapes.size(); ++k) {
    scene_.motion.search.standing.push_back(shapes[k]);
    scene_.motion.search.standing.back().object = object;
  }
}

/// Of robots with bodies that float: what stands is an object of its own, on which these stand as on any table.
void SceneLoader::stand_apart(ContactSearch& search) {
  const auto n = static_cast<Index>(object_.size());
  std::vector<bool> floating(static_cast<std::size_t>(objects_));
  for (Index i = 0; i < n; ++i)
    if (floats(scene_.model, i)) floating[static_cast<std::size_t>(object_[static_cast<std::size_t>(i)])] = true;
  for (Standing& s : search.standing)
    if (floating[static_cast<std::size_t>(s.object)]) s.object = -1 - s.object;
  for (Index i = 0; i < n; ++i)
    if (const Index of = object_[static_cast<std::size_t>(i)]; floating[static_cast<std::size_t>(of)] && !floats(scene_.model, i)) search.apart.emplace_back(-1 - of, i);
  std::sort(search.apart.begin(), search.apart.end());
}

/// Every body an object of its own, but for neighbours and for those that touch already: they stand so by their model.
void SceneLoader::collide_within(ContactSearch& search) {
  for (Standing& s : search.standing) s.object = -1 - s.object;
  search.apart = neighbours(scene_.model, object_, search.standing);
  for (std::size_t i = 0; i < object_.size(); ++i) search.object[i] = static_cast<Index>(i);
  std::vector<std::string> none;
  const std::size_t joined = search.apart.size();
  ContactSearch robots = search;
  robots.ground = false;
  for (const ContactPoint& p : find_contacts(scene_.model, poses_, robots, none)) {
    const Index of = object_[static_cast<std::size_t>(p.body)];
    if (p.standing < 0 && of == object_[static_cast<std::size_t>(p.other)]) search.apart.push_back(std::minmax(p.body, p.other));
    if (p.standing >= 0 && search.standing[static_cast<std::size_t>(p.standing)].object == -1 - of && !floats(scene_.model, p.body)) search.apart.emplace_back(-1 - of, p.body);
  }
  std::sort(search.apart.begin(), search.apart.end());
  search.apart.erase(std::unique(search.apart.begin(), search.apart.end()), search.apart.end());
  if (const std::size_t touching = search.apart.size() - joined; touching > 0)
    scene_.notes.push_back(std::to_string(touching) + " pairs of links of one robot touch at the given pose and are not tested against each other");
}

/// A link, a box, or ground, as contacts know them: a fixed link has as many numbers as shapes.
std::vector<Index> SceneLoader::touched(const Yaml& y) const {
  const End end = end_of(y);
  if (end.frame.body != ground) return {end.frame.body};
  if (end.name == "ground") return {ground};
  std::vector<Index> out;
  const std::vector<Standing>& standing = scene_.motion.search.standing;
  for (std::size_t k = 0; k < standing.size(); ++k)
    if (standing[k].name == end.name) out.push_back(-3 - static_cast<Index>(k));
  return out;
}

/// {of, to, friction, …}: coefficients of the contacts of two, or of one with all.
void SceneLoader::read_between(const Yaml& y) {
  y.keys({"of", "to", "friction", "torsional_friction", "rolling_friction", "restitution"});
  SceneMotion::Between b;
  b.where = y.file_and_line();
  if (y.has("friction")) b.friction = y.at("friction").non_negative("");
  if (y.has("torsional_friction")) b.torsional = y.at("torsional_friction").non_negative(" [m]");
  if (y.has("rolling_friction")) b.rolling = y.at("rolling_friction").non_negative(" [m]");
  if (y.has("restitution")) b.restitution = restitution(y.at("restitution"));
  for (const Index a : touched(y.at("of")))
    for (const Index other : y.has("to") ? touched(y.at("to")) : std::vector<Index>{SceneMotion::Between::any}) {
      b.a = a, b.b = other;
      scene_.motion.between.push_back(b);
    }
}

double SceneLoader::restitution(const Yaml& y) {
  const double e = y.non_negative("");
  if (e > 1) y.fail(number_text(e) + " is above 1", "a number from 0 to 1; 1 bounces back with the speed it came");
  return e;
}

void SceneLoader::detect(const Yaml* y) {
  ContactSearch& search = scene_.motion.search;
  search.ground = scene_.has_ground;
  search.ground_height = scene_.ground_height;
  search.object = object_;
  scene_.motion.detects = true;
  if (y != nullptr && y->has("margin")) search.margin = y->at("margin").non_negative(" [m]");
  const bool within = y != nullptr && y->has("self") && y->at("self").boolean();
  if (y != nullptr && y->has("friction")) scene_.motion.friction = y->at("friction").non_negative("");
  if (y != nullptr && y->has("restitution")) scene_.motion.restitution = restitution(y->at("restitution"));
  if (y != nullptr && y->has("torsional_friction")) scene_.motion.torsional_friction = y->at("torsional_friction").non_negative(" [m]");
  if (y != nullptr && y->has("rolling_friction")) scene_.motion.rolling_friction = y->at("rolling_friction").non_negative(" [m]");
  Index vertices = 64;
  if (y != nullptr && y->has("hull_vertices") && (vertices = y->at("hull_vertices").index()) < 10)
    y->at("hull_vertices").fail(std::to_string(vertices) + " vertices are too few", "a whole number >= 10; leave it out for 64");
  Findings found(strict_);
  const auto has_own = [&](const Robot& r) { return std::any_of(r.bodies.begin(), r.bodies.end(), [&](Index i) { return floats(scene_.model, i); }) && r.root_joint.empty(); };
  for (std::size_t k = 0; k < robots_.size(); ++k) {
    Robot& r = robots_[k];
    const std::size_t before = r.standing.size();
    if (scene_.has_ground || objects_ > 1 || within || has_own(r)) add_hulls(scene_.model, r, vertices, search.margin, found);
    stand(r.standing, before, static_cast<Index>(k));
  }
  scene_.notes.insert(scene_.notes.end(), found.notes.begin(), found.notes.end());
  scene_.warnings.insert(scene_.warnings.end(), found.warnings.begin(), found.warnings.end());
  if (within) collide_within(search);
  else stand_apart(search);
  if (y != nullptr && y->has("between"))
    for (const Yaml& item : y->at("between").list("a list of {of, to, friction, torsional_friction, rolling_friction, restitution}")) read_between(item);
  for (const ContactPoint& p : find_contacts(scene_.model, poses_, search, scene_.notes)) {
    const auto i = static_cast<std::size_t>(p.body);
    Constraint c;
    c.kind = Constraint::Kind::contact;
    c.name = "contact " + scene_.model.bodies[i].name + " - " + (p.standing >= 0 ? search.standing[static_cast<std::size_t>(p.standing)].name : p.other == ground ? "ground" : scene_.model.bodies[static_cast<std::size_t>(p.other)].name);
    const Matrix3<double> Rt = poses_.rotation[i].transpose();
    c.a = {p.body, {Rt * frame_about(p.normal), Rt * (p.point - poses_.position[i])}};
    c.b = {p.other, relative_pose(poses_, p.other, p.body) * c.a.placement};
    c.friction = p.friction >= 0 ? p.friction : scene_.ground_friction;
    if (p.other == ground && p.standing < 0 && scene_.ground_friction >= 0) c.friction = scene_.ground_friction;
    if (y != nullptr && y->has("friction")) c.friction = y->at("friction").non_negative("");
    if (const double own = own_coefficients(scene_.motion.between, p).friction; own >= 0) c.friction = own;
    scene_.model.constraints.push_back(std::move(c));
    own_damping_.push_back(y != nullptr && y->has("damping") ? std::optional<Yaml>(y->at("damping")) : std::nullopt);
  }
}

void SceneLoader::read_contacts(const Yaml& y) {
  const std::string accepted = "detect, {detect: true, self, margin, hull_vertices, friction, torsional_friction, rolling_friction, restitution, between, damping}, or a list of {of, at, to, normal, friction, damping}";
  if (y.is_list()) {
    for (const Yaml& item : y.list(accepted)) read_contact(item, scene_.ground_friction);
  } else if (y.is_map()) {
    y.keys({"detect", "self", "margin", "hull_vertices", "friction", "torsional_friction", "rolling_friction", "restitution", "between", "damping"});
    if (y.at("detect").boolean()) detect(&y);
  } else if (y.text(accepted) == "detect") {
    detect(nullptr);
  } else {
    y.fail(in_quotes(y.text(accepted)) + " is not understood", did_you_mean(y.text(accepted), std::array{"detect"}) + accepted + "; leave it out for none");
  }
}

/// R⁻¹ over `rows` rows from `row` on: a number, a list, or a symmetric positive semidefinite block.
void SceneLoader::damp(const Yaml& y, Index row, Index rows) {
  const std::string n = std::to_string(rows), unit = " [1/kg]";
  auto entry = [&](Index k) -> double& { return scene_.damping.diagonal[static_cast<std::size_t>(row + k)]; };
  if (y.is_scalar()) {
    for (Index k = 0; k < rows; ++k) entry(k) = y.non_negative(unit);
    return;
  }
  const std::vector<Yaml> items = y.list("a number >= 0, a list of " + n + ", or a symmetric block of " + n + " x " + n + unit);
  if (items.empty() || !items[0].is_list()) {
    if (static_cast<Index>(items.size()) != rows) y.fail("has " + std::to_string(items.size()) + " entries", n + " numbers >= 0" + unit + "; one number stands for all");
    for (Index k = 0; k < rows; ++k) entry(k) = items[static_cast<std::size_t>(k)].non_negative(unit);
    return;
  }
  const MatrixX<double> R = y.matrix(rows, rows, unit);
  if (R != R.transpose()) y.fail("the block is not symmetric", "a symmetric positive semidefinite block" + unit + "; both halves must have the same digits");
  const double least = Eigen::SelfAdjointEigenSolver<MatrixX<double>>(R, Eigen::EigenvaluesOnly).eigenvalues()[0];
  if (least < -30 * std::numeric_limits<double>::epsilon() * static_cast<double>(rows) * R.norm())
    y.fail("the block has the eigenvalue " + number_text(least), "a symmetric positive semidefinite block" + unit + "; make the diagonal larger");
  for (Index k = 0; k < rows; ++k) entry(k) = 0;
  scene_.damping.blocks.push_back({row, R});
}

void SceneLoader::read_damping(const Yaml& root) {
  std::vector<Index> first{0};
  for (const Constraint& c : scene_.model.constraints) first.push_back(first.back() + row_count(scene_.model, c));
  scene_.damping = Damping<double>::uniform(first.back(), 0);
  if (root.has("damping")) {
    const Yaml y = root.at("damping");
    if (y.is_list() && y.list("").size() > 0 && y.list("")[0].is_list()) y.fail("a block over all rows", "a number or a list; blocks belong to single constraints");
    damp(y, 0, first.back());
    if (y.is_scalar()) scene_.motion.contact_damping = y.non_negative(" [1/kg]");
  }
  if (root.has("contacts") && root.at("contacts").is_map() && root.at("contacts").has("damping") && root.at("contacts").at("damping").is_scalar())
    scene_.motion.contact_damping = root.at("contacts").at("damping").non_negative(" [1/kg]");
  for (std::size_t k = 0; k < own_damping_.size(); ++k)
    if (own_damping_[k]) damp(*own_damping_[k], first[k], first[k + 1] - first[k]);
}

}  // namespace delassus
