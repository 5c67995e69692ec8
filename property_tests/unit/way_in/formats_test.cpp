// The same robot in three formats: random trees (random_urdf.h) written as URDF, MJCF and SDF, with loops where the formats
// have them, give the same M, and the same rows up to rotations of each closure's own three.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <functional>
#include <sstream>

#include "algorithms/kit/test_scalars.h"
#include "algorithms/mechanism/kinematics.h"
#include "models/robot.h"
#include "property_tests/unit/way_in/random_urdf.h"
#include "property_tests/unit/operators/path_sums.h"
#include "property_tests/unit/way_in/temporary.h"
#include "property_tests/laws/verdict.h"
#include "reference/definition.h"

namespace delassus::formats_test {
namespace {

using laws::Verdict;
using test::Computed;
using test::Origin;
using test::Urdf;
using test::UrdfJoint;
using test::Values;
using Quads = MatrixX<Quad>;

constexpr double eps = 0x1p-53;
constexpr unsigned robots = 20;
enum Format : std::size_t { urdf, mjcf, sdf, formats };
constexpr const char* names[] = {"URDF", "MJCF", "SDF"};
constexpr const char* extensions[] = {".urdf", ".xml", ".sdf"};

/// A point of link a that is one of link b too, when all joints are at 0.
struct Pin {
  std::string a, b;
  Vector3<double> at;  ///< in a
};

struct Drawn {
  Urdf tree;
  std::vector<Pin> pins;
};

/// A robot that all three can say: hinges, slides and fixed joints, every link with an inertia, no armature (SDF has none).
Drawn drawn(unsigned seed) {
  Drawn out{test::random_urdf(seed), {}};
  unit::Random random(seed);
  for (UrdfJoint& j : out.tree.joints) {
    if (j.type == "planar") j.type = "prismatic";
    if (j.type == "floating") j.type = "continuous";
    if (j.type == "revolute") j.type = "continuous";
    if (j.type == "prismatic") j.limit = {-4, 4, 5, 10};
    else j.limit.reset();
    j.dynamics.reset();
    if (j.axis.norm() < 0.1) j.axis = {0, 1, 0};
  }
  const auto any = [&](std::size_t n) { return static_cast<std::size_t>(random.number(0, 0.999) * static_cast<double>(n)); };
  for (test::Link& l : out.tree.links) {
    l.collisions.clear();
    if (!l.inertial) l.inertial = test::Inertial{{}, 0.5, 0.011, 0.001, -0.002, 0.012, 0.003, 0.013};
  }
  for (int k = 0; k < 2 && out.tree.links.size() > 2; ++k) {
    const Pin pin{out.tree.links[1 + any(out.tree.links.size() - 1)].name, out.tree.links[any(out.tree.links.size())].name, random.vector()};
    if (pin.a != pin.b) out.pins.push_back(pin);
  }
  return out;
}

std::string triple(const Vector3<double>& x) {
  std::ostringstream out;
  out.precision(17);
  out << x[0] << ' ' << x[1] << ' ' << x[2];
  return out.str();
}

/// The six numbers in the link's own axes: neither MJCF nor a bare <inertia> turns them.
test::Inertial in_link(const test::Link& l) { return test::moved(*l.inertial, test::pose_of({}), true); }

void mjcf_body(std::ostream& to, const Urdf& robot, const std::string& link, const UrdfJoint* by) {
  const test::Link& l = *std::find_if(robot.links.begin(), robot.links.end(), [&](const test::Link& x) { return x.name == link; });
  to << "<body name='" << link << "'";
  if (by != nullptr) to << " pos='" << triple(by->origin.xyz) << "' euler='" << triple(by->origin.rpy) << "'";
  to << ">";
  if (by == nullptr) to << "<freejoint/>";
  else if (by->type != "fixed") to << "<joint name='" << by->name << "' type='" << (by->type == "prismatic" ? "slide" : "hinge") << "' axis='" << triple(by->axis) << "'/>";
  const test::Inertial in = in_link(l);
  to << "<inertial pos='" << triple(in.origin.xyz) << "' mass='" << in.mass << "' fullinertia='" << in.ixx << ' ' << in.iyy << ' ' << in.izz << ' ' << in.ixy << ' ' << in.ixz
     << ' ' << in.iyz << "'/>\n";
  for (const UrdfJoint& j : robot.joints)
    if (j.parent == link) mjcf_body(to, robot, j.child, &j);
  to << "</body>\n";
}

std::string mjcf_text(const Drawn& d) {
  std::ostringstream out;
  out.precision(17);
  out << "<mujoco><compiler angle='radian' eulerseq='XYZ' balanceinertia='false'/><worldbody>";
  mjcf_body(out, d.tree, d.tree.links[0].name, nullptr);
  out << "</worldbody><equality>";
  for (const Pin& p : d.pins) out << "<connect body1='" << p.a << "' body2='" << p.b << "' anchor='" << triple(p.at) << "'/>";
  for (const UrdfJoint& j : d.tree.joints)
    if (!j.master.empty() && j.type != "fixed") out << "<joint joint1='" << j.name << "' joint2='" << j.master << "' polycoef='" << j.offset << ' ' << j.multiplier << " 0 0 0'/>";
  out << "</equality></mujoco>";
  return out.str();
}

/// Poses by way of the joints, or with each joint at its child's own frame.
std::string sdf_text(const Drawn& d, bool of_joints) {
  std::ostringstream out;
  out.precision(17);
  const auto pose = [](const Origin& o) { return triple(o.xyz) + " " + triple(o.rpy); };
  out << "<sdf version='1.9'><model name='m'>\n";
  const auto link = [&](const test::Link& l) {
    out << "<link name='" << l.name << "'>";
    for (const UrdfJoint& j : d.tree.joints) {
      if (j.child != l.name) continue;
      if (of_joints) out << "<pose relative_to='" << j.name << "'/>";
      else out << "<pose relative_to='" << j.parent << "'>" << pose(j.origin) << "</pose>";
    }
    const test::Inertial& in = *l.inertial;
    out << "<inertial><pose>" << pose(in.origin) << "</pose><mass>" << in.mass << "</mass><inertia><ixx>" << in.ixx << "</ixx><ixy>" << in.ixy << "</ixy><ixz>" << in.ixz << "</ixz><iyy>"
        << in.iyy << "</iyy><iyz>" << in.iyz << "</iyz><izz>" << in.izz << "</izz></inertia></inertial></link>\n";
  };
  for (const test::Link& l : d.tree.links) link(l);
  for (const UrdfJoint& j : d.tree.joints) {
    out << "<joint name='" << j.name << "' type='" << j.type << "'>";
    if (of_joints) out << "<pose relative_to='" << j.parent << "'>" << pose(j.origin) << "</pose>";
    out << "<parent>" << j.parent << "</parent><child>" << j.child << "</child>";
    if (j.type != "fixed") out << "<axis><xyz>" << triple(j.axis) << "</xyz></axis>";
    out << "</joint>\n";
  }
  for (std::size_t k = 0; k < d.pins.size(); ++k)
    out << "<joint name='pin" << k << "' type='ball'><pose>" << triple(d.pins[k].at) << " 0 0 0</pose><parent>" << d.pins[k].b << "</parent><child>" << d.pins[k].a << "</child></joint>";
  out << "</model></sdf>\n";
  return out.str();
}

struct Read {
  Model model;
  Robot robot;
};

/// Reads the text; false where this build lacks the format's library.
bool read(const std::string& text, Format format, Read& out) {
  RobotOptions o;
  o.file = test::temporary(std::string("formats") + extensions[format]).string();
  o.robot = "r";
  std::ofstream(o.file) << text;
  try {
    out.robot = add_robot(out.model, o);
  } catch (const ModelError& e) {
    if (std::string(e.what()).find("built without") == std::string::npos) throw;
    return false;
  }
  return true;
}

struct Matrices {
  Quads M, J;  ///< columns in the order of the computation
};

/// `pins`: the rows of pins; otherwise those of mimics.
Matrices matrices(const Read& r, const Values& values, const Computed& c, bool pins) {
  VectorX<double> q = neutral(r.model);
  std::vector<Index> order;
  for (std::size_t b = 0; b < r.model.bodies.size(); ++b) {
    const Body& body = r.model.bodies[b];
    const std::string joint = body.joint.type == JointType::floating ? "base" : body.joint.name.substr(2);
    const std::vector<double>& value = values.at(joint);
    for (Index k = 0; k < q_size(body.joint.type); ++k) q[r.model.first_q[b] + k] = value[static_cast<std::size_t>(k)];
    for (Index k = 0; k < dof_count(body.joint.type); ++k) order.push_back(c.column.at(joint) + k);
  }
  Model model = r.model;
  std::erase_if(model.constraints, [&](const Constraint& x) { return (x.kind == Constraint::Kind::point) != pins; });
  const Problem<Quad> p = kinematics<double>(model, q).cast<Quad>();
  const Quads M = reference::mass_matrix(p), J = reference::constraint_jacobian(p);
  Matrices out{Quads(M), Quads(J)};
  for (Index i = 0; i < M.rows(); ++i) {
    const Index k = order[static_cast<std::size_t>(i)];
    for (Index j = 0; j < M.cols(); ++j) out.M(k, order[static_cast<std::size_t>(j)]) = M(i, j);
    out.J.col(k) = J.col(i);
  }
  return out;
}

/// Σ of the three squared rows of each pin: whatever axes they are read in.
Quads squares(const Quads& J, Index pin) { return reference::product(Quads(J.middleRows(3 * pin, 3).transpose()), Quads(J.middleRows(3 * pin, 3))); }

/// A bound of `squares`: a point of link l moves by its turns times the way to it and by its own motion.
Quads square_bound(const Drawn& d, const Computed& c, const Pin& pin) {
  const Index n = c.M.rows();
  VectorX<Quad> size = VectorX<Quad>::Constant(n, Quad(0));
  const Quad steps(static_cast<double>(d.tree.joints.size() + 1));
  for (const std::string& l : {pin.a, pin.b}) {
    const Quads& motion = c.motion_size.at(l);
    const Quad arm = Quad(pin.at.norm()) + c.way.at(pin.a) + c.way.at(pin.b);
    for (Index k = 0; k < n; ++k) size[k] += steps * (motion.col(k).tail(3).maxCoeff() + arm * motion.col(k).head(3).maxCoeff());
  }
  Quads out(n, n);
  for (Index i = 0; i < n; ++i)
    for (Index j = 0; j < n; ++j) out(i, j) = size[i] * size[j];
  return out;
}

/// All three pairs of formats that this build reads.
Verdict compare(const Drawn& d, const Computed& c, const std::vector<const Read*>& all, const Values& values) {
  Verdict worst;
  for (std::size_t x = 0; x < all.size(); ++x)
    for (std::size_t y = x + 1; y < all.size(); ++y) {
      if (all[x] == nullptr || all[y] == nullptr) continue;
      const Matrices a = matrices(*all[x], values, c, false), b = matrices(*all[y], values, c, false);
      worst = laws::worst(worst, laws::judge(Quads(a.M - b.M), c.M_size, eps, "M: sums of sizes"));
      if (y == mjcf) {
        if (a.J.rows() != b.J.rows()) return laws::failure("mimics differ");
        for (Index r = 0; r < a.J.rows(); ++r) {
          const Quads bound = Quads::Constant(1, a.J.cols(), Quad(static_cast<double>(d.tree.joints.size())) * (Quad(3) + c.way.at(d.tree.links.back().name)));
          Verdict best = laws::failure("no such mimic");
          for (Index s = 0; s < b.J.rows(); ++s) {
            const Verdict v = laws::judge(Quads(a.J.row(r) - b.J.row(s)), bound, eps, "J of mimics");
            if (v.ratio < best.ratio) best = v;
          }
          worst = laws::worst(worst, best);
        }
      }
      if (x == urdf) continue;
      const Matrices e = matrices(*all[x], values, c, true), f = matrices(*all[y], values, c, true);
      if (e.J.rows() != f.J.rows()) return laws::failure("loops differ");
      Index row = 0;
      for (const Pin& pin : d.pins) {
        if (3 * row == e.J.rows()) break;  // both ends on one body: no rows
        if (all[x]->robot.links.at(pin.a).body == all[x]->robot.links.at(pin.b).body) continue;
        worst = laws::worst(worst, laws::judge(Quads(squares(e.J, row) - squares(f.J, row)), square_bound(d, c, pin), eps, "JᵀJ of a pin: sizes"));
        ++row;
      }
    }
  return worst;
}

struct Written {
  Read read[formats];
  std::vector<const Read*> all;
};

Written written(const Drawn& d, unsigned seed) {
  Written out;
  const std::string texts[] = {test::text(d.tree), mjcf_text(d), sdf_text(d, seed % 2 == 0)};
  for (std::size_t f = 0; f < formats; ++f) out.all.push_back(read(texts[f], static_cast<Format>(f), out.read[f]) ? &out.read[f] : nullptr);
  return out;
}

TEST(Formats, the_same_robot_in_urdf_mjcf_and_sdf_is_the_same) {
  double worst = 0;
  Index rows = 0;
  for (unsigned seed = 0; seed < robots; ++seed) {
    const Drawn d = drawn(seed);
    const Written w = written(d, seed);
    if (w.all[mjcf] == nullptr || w.all[sdf] == nullptr) std::printf("  built without %s: fewer pairs\n", names[w.all[mjcf] == nullptr ? mjcf : sdf]);
    const Values values = test::random_values(d.tree, seed);
    const Verdict v = compare(d, test::compute(d.tree, values, "floating"), w.all, values);
    EXPECT_TRUE(v.passed()) << "robot " << seed << ": " << v.ratio << " " << v.bound << " " << v.note;
    worst = std::max(worst, v.ratio);
    if (w.all[sdf] != nullptr) rows += static_cast<Index>(w.all[sdf]->model.constraints.size());
  }
  std::printf("  largest ratio %.2g, %d pins\n", worst, static_cast<int>(rows));
}

// What a reader could do wrong, in any one of the formats.
TEST(Formats, the_comparison_sees_every_seeded_difference) {
  const std::vector<std::pair<const char*, std::function<void(Model&)>>> wrong{
      {"an axis reversed", [](Model& m) { m.bodies[1].joint.axis *= -1; }},
      {"an axis turned by 1e-9", [](Model& m) { m.bodies[1].joint.axis = (m.bodies[1].joint.axis + 1e-9 * m.bodies[1].joint.axis.unitOrthogonal()).normalized(); }},
      {"a link 1 nm off", [](Model& m) { m.bodies[1].joint.placement.translation[0] += 1e-9; }},
      {"products of inertia of the other sign", [](Model& m) { m.bodies[1].inertia(0, 1) *= -1, m.bodies[1].inertia(1, 0) *= -1; }},
      {"a mass 1e-9 off", [](Model& m) { m.bodies[0].mass *= 1 + 1e-9; }},
      {"a pin 1 nm off", [](Model& m) { for (Constraint& c : m.constraints) if (c.kind == Constraint::Kind::point) c.a.placement.translation[0] += 1e-9; }},
      {"a pin forgotten", [](Model& m) { std::erase_if(m.constraints, [](const Constraint& c) { return c.kind == Constraint::Kind::point; }); }},
      {"a mimic of the other sign", [](Model& m) { for (Constraint& c : m.constraints) if (c.kind == Constraint::Kind::coupling) c.terms[1].coefficient *= -1; }}};
  for (const auto& [name, change] : wrong)
    for (std::size_t f = 0; f < formats; ++f) {
      double seen = 0;
      bool changed = false;
      for (unsigned seed = 0; seed < 3; ++seed) {
        const Drawn d = drawn(seed);
        Written w = written(d, seed);
        if (w.all[f] == nullptr || w.all[mjcf] == nullptr || w.all[sdf] == nullptr || w.read[f].model.bodies.size() < 2) continue;
        const bool pin = std::string(name).rfind("a pin", 0) == 0, mimic = std::string(name).rfind("a mimic", 0) == 0;
        const auto has = [&](Constraint::Kind k) { return std::any_of(w.read[f].model.constraints.begin(), w.read[f].model.constraints.end(), [&](const Constraint& c) { return c.kind == k; }); };
        if ((pin && !has(Constraint::Kind::point)) || (mimic && !has(Constraint::Kind::coupling))) continue;
        change(w.read[f].model);
        changed = true;
        const Values values = test::random_values(d.tree, seed);
        seen = std::max(seen, compare(d, test::compute(d.tree, values, "floating"), w.all, values).ratio);
      }
      if (changed) {
        EXPECT_GE(seen, 30) << name << " in " << names[f];
      }
    }
}

}  // namespace
}  // namespace delassus::formats_test
