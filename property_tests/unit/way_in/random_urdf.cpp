#include "algorithms/kit/test_scalars.h"
#include "property_tests/unit/way_in/random_urdf.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <sstream>

namespace delassus::test {
namespace {

using V3 = Vector3<double>;
using Q3 = Vector3<Quad>;
using QM = Matrix3<Quad>;

class Dice {
 public:
  explicit Dice(unsigned seed) : engine_(seed) {}
  double number(double low, double high) { return low + (high - low) * static_cast<double>(engine_() >> 11) * 0x1p-53; }
  bool chance(double p) { return number(0, 1) < p; }
  std::size_t below(std::size_t n) { return engine_() % n; }
  V3 vector(double size) { return {number(-size, size), number(-size, size), number(-size, size)}; }
  Origin origin() { return {vector(0.6), {number(-3, 3), number(-1.4, 1.4), number(-3, 3)}}; }

 private:
  std::mt19937_64 engine_;
};

/// Of a solid ellipsoid: no two moments alike, products of inertia from a rotation of its own.
Inertial random_inertial(Dice& dice) {
  Inertial in;
  in.mass = dice.number(0.3, 4);
  in.origin = dice.origin();
  const V3 s(dice.number(0.05, 0.1), dice.number(0.12, 0.2), dice.number(0.25, 0.4));
  const V3 moments = in.mass / 5 * V3(s[1] * s[1] + s[2] * s[2], s[0] * s[0] + s[2] * s[2], s[0] * s[0] + s[1] * s[1]);
  const QM R = pose_of(dice.origin()).rotation, I = R * moments.cast<Quad>().asDiagonal() * R.transpose();
  auto d = [&](int i, int j) { return static_cast<double>(I(i, j)); };
  in.ixx = d(0, 0), in.ixy = d(0, 1), in.ixz = d(0, 2), in.iyy = d(1, 1), in.iyz = d(1, 2), in.izz = d(2, 2);
  return in;
}

Collision random_collision(Dice& dice) {
  const char* kinds[] = {"box", "sphere", "cylinder", "capsule"};
  return {kinds[dice.below(4)], V3(dice.number(0.02, 0.05), dice.number(0.06, 0.1), dice.number(0.11, 0.2)), dice.origin()};
}

std::string random_type(Dice& dice) {
  const char* types[] = {"fixed", "fixed", "fixed", "revolute", "revolute", "continuous", "continuous", "prismatic", "prismatic", "planar", "floating"};
  return types[dice.below(std::size(types))];
}

bool single(const std::string& type) { return dofs_of(type) == 1; }

UrdfJoint random_joint(Dice& dice, std::size_t k) {
  UrdfJoint j;
  j.name = "j" + std::to_string(k);
  j.type = random_type(dice);
  j.child = "l" + std::to_string(k);
  j.origin = dice.origin();
  if (j.type != "fixed" && j.type != "floating" && dice.chance(0.8)) j.axis = dice.vector(1);
  if (j.type == "revolute" || j.type == "prismatic") j.limit = {dice.number(-4, -3), dice.number(3, 4), dice.number(5, 9), dice.number(10, 20)};
  if (dofs_of(j.type) > 0 && dice.chance(0.6)) j.dynamics = {dice.number(0.1, 0.2), dice.number(0.3, 0.4), dice.number(0.01, 0.09)};
  return j;
}

/// Some joints of one degree of freedom follow others, in chains but not in circles.
void add_mimics(Dice& dice, Urdf& robot) {
  std::vector<std::size_t> singles;
  for (std::size_t k = 0; k < robot.joints.size(); ++k)
    if (single(robot.joints[k].type)) singles.push_back(k);
  std::shuffle(singles.begin(), singles.end(), std::mt19937_64(dice.below(1000)));
  for (std::size_t k = 1; k < singles.size(); ++k) {
    if (!dice.chance(0.5)) continue;
    UrdfJoint& j = robot.joints[singles[k]];
    j.master = robot.joints[singles[dice.chance(0.6) ? k - 1 : dice.below(k)]].name;
    j.multiplier = dice.chance(0.5) ? dice.number(-2, -0.5) : dice.number(0.5, 2);
    j.offset = dice.number(-0.4, 0.4);
  }
}

class Writer {
 public:
  Writer() { out_.precision(17); }
  Writer& operator()(const std::string& raw) {
    out_ << raw;
    return *this;
  }
  Writer& number(const char* key, double x) {
    out_ << ' ' << key << "=\"" << x << '"';
    return *this;
  }
  Writer& triple(const char* key, const V3& v) {
    out_ << ' ' << key << "=\"" << v[0] << ' ' << v[1] << ' ' << v[2] << '"';
    return *this;
  }
  void origin(const Origin& o) { (*this)("<origin").triple("rpy", o.rpy).triple("xyz", o.xyz)("/>"); }
  [[nodiscard]] std::string text() const { return out_.str(); }

 private:
  std::ostringstream out_;
};

void write(Writer& w, const Collision& c) {
  w("<collision>").origin(c.origin);
  w("<geometry><" + c.kind);
  if (c.kind == "box") w.triple("size", c.size);
  else w.number("radius", c.size[0]);
  if (c.kind == "cylinder" || c.kind == "capsule") w.number("length", c.size[1]);
  w("/></geometry></collision>");
}

void write(Writer& w, const Link& link) {
  w("<link name=\"" + link.name + "\">");
  if (const auto& in = link.inertial) {
    w("<inertial>").origin(in->origin);
    w("<mass").number("value", in->mass)("/><inertia");
    w.number("ixx", in->ixx).number("ixy", in->ixy).number("ixz", in->ixz).number("iyy", in->iyy).number("iyz", in->iyz).number("izz", in->izz);
    w("/></inertial>");
  }
  for (const Collision& c : link.collisions) write(w, c);
  w("</link>\n");
}

void write(Writer& w, const UrdfJoint& j) {
  w("<joint name=\"" + j.name + "\" type=\"" + j.type + "\"><parent link=\"" + j.parent + "\"/><child link=\"" + j.child + "\"/>").origin(j.origin);
  if (j.axis != V3(1, 0, 0)) w("<axis").triple("xyz", j.axis)("/>");
  if (j.limit) w("<limit").number("velocity", j.limit->velocity).number("upper", j.limit->upper).number("effort", j.limit->effort).number("lower", j.limit->lower)("/>");
  if (j.dynamics) w("<dynamics").number("friction", j.dynamics->friction).number("armature", j.dynamics->armature).number("damping", j.dynamics->damping)("/>");
  if (!j.master.empty()) w("<mimic joint=\"" + j.master + "\"").number("multiplier", j.multiplier).number("offset", j.offset)("/>");
  w("</joint>\n");
}

}  // namespace

Index dofs_of(const std::string& type) { return type == "fixed" ? 0 : type == "planar" ? 3 : type == "floating" ? 6 : 1; }

Urdf random_urdf(unsigned seed) {
  Dice dice(seed);
  Urdf robot;
  const std::size_t links = 2 + dice.below(9);
  for (std::size_t k = 0; k < links; ++k) {
    Link link;
    link.name = "l" + std::to_string(k);
    UrdfJoint joint;
    if (k > 0) {
      joint = random_joint(dice, k);
      joint.parent = "l" + std::to_string(dice.chance(0.6) ? k - 1 : dice.below(k));
      robot.joints.push_back(joint);
    }
    if (joint.type != "fixed" || dice.chance(0.7)) link.inertial = random_inertial(dice);
    while (dice.chance(0.5)) link.collisions.push_back(random_collision(dice));
    robot.links.push_back(link);
  }
  add_mimics(dice, robot);
  std::shuffle(robot.joints.begin(), robot.joints.end(), std::mt19937_64(seed));
  return robot;
}

std::string text(const Urdf& robot) {
  Writer w;
  w("<robot name=\"random\">\n");
  for (const UrdfJoint& j : robot.joints) write(w, j);
  for (std::size_t k = robot.links.size(); k-- > 0;) write(w, robot.links[k]);
  return w("</robot>\n").text();
}

Values random_values(const Urdf& robot, unsigned seed) {
  Dice dice(seed + 7919);
  Values values;
  auto free = [&] {
    std::vector<double> q;
    for (int k = 0; k < 7; ++k) q.push_back(dice.number(-1, 1));
    Eigen::Map<Eigen::Vector4d>(q.data() + 3).normalize();
    return q;
  };
  values["base"] = free();
  for (const UrdfJoint& j : robot.joints) {
    if (j.type == "floating") values[j.name] = free();
    else if (j.type == "planar") values[j.name] = {dice.number(-2, 2), dice.number(-1, 1), dice.number(-1, 1)};
    else if (j.type != "fixed") values[j.name] = {dice.number(-2, 2)};
  }
  return values;
}

}  // namespace delassus::test
