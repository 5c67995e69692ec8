// Contacts between links of one robot: only where asked for, not between neighbours, nor where links touch from the start.
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>

#include "models/contacts.h"
#include "models/scene.h"
#include "property_tests/unit/way_in/temporary.h"

namespace delassus::self_contacts_test {
namespace {

std::string link(const std::string& name, const std::string& box, double middle) {
  const std::string shape = box.empty() ? "" : "<collision><origin xyz='" + std::to_string(middle) + " 0 0'/><geometry><box size='" + box + "'/></geometry></collision>";
  return "<link name='" + name + "'><inertial><mass value='1'/><inertia ixx='1' iyy='1' izz='1' ixy='0' ixz='0' iyz='0'/></inertial>" + shape + "</link>";
}

std::string joint(const std::string& parent, const std::string& child, double at) {
  return "<joint name='to_" + child + "' type='continuous'><parent link='" + parent + "'/><child link='" + child + "'/><origin xyz='" + std::to_string(at) +
         " 0 0'/><axis xyz='0 1 0'/></joint>";
}

/// An arm of two boxes on a box, a wrist without shapes and a tool at its end; a lid that stands in the first box of the arm.
Scene arm(const std::string& contacts) {
  const auto robot = test::temporary("arm.urdf");
  std::ofstream(robot) << "<robot name='arm'>" << link("base", "0.2 0.2 0.2", 0) << link("upper", "0.4 0.1 0.1", 0.25) << link("lower", "1 0.1 0.1", 0.5) << link("wrist", "", 0)
                       << link("tool", "0.1 0.1 0.1", 0.06) << link("lid", "0.1 0.05 0.05", 0.2) << joint("base", "upper", 0.15) << joint("upper", "lower", 0.5)
                       << joint("lower", "wrist", 1) << joint("wrist", "tool", 0) << joint("base", "lid", 0.15) << "</robot>";
  const auto file = test::temporary("self.yaml");
  std::ofstream(file) << "robots:\n  - {name: arm, file: arm.urdf, base: free}\ncontacts: " << contacts << "\n";
  return load_scene(file.string());
}

using Named = std::pair<std::string, std::string>;

/// Pairs of links that touch with the lower arm folded over the upper one by this angle, and the tool by another.
std::vector<Named> touching(const Scene& s, double fold, double tool) {
  VectorX<double> q = s.q;
  for (std::size_t i = 0; i < s.model.bodies.size(); ++i) {
    if (s.model.bodies[i].name.find("lower") != std::string::npos) q[s.model.first_q[static_cast<Index>(i)]] = fold;
    if (s.model.bodies[i].name.find("tool") != std::string::npos) q[s.model.first_q[static_cast<Index>(i)]] = tool;
  }
  Poses<double> at;
  poses(s.model, q, at);
  std::vector<std::string> notes;
  std::vector<Named> out;
  for (const ContactPoint& c : find_contacts(s.model, at, s.motion.search, notes)) {
    const auto name = [&](Index i) {
      const std::string& full = s.model.bodies[static_cast<std::size_t>(i)].name;
      return full.substr(full.find('/') + 1);
    };
    const Named pair(name(c.body), name(c.other));
    if (std::find(out.begin(), out.end(), pair) == out.end()) out.push_back(pair);
  }
  return out;
}

Index noted(const Scene& s) {
  for (const std::string& n : s.notes)
    if (n.find("of one robot touch at the given pose") != std::string::npos) return std::stol(n);
  return 0;
}

TEST(SelfContacts, only_where_asked_for) {
  for (const char* off : {"detect", "{detect: true}", "{detect: true, self: false}"}) {
    const Scene s = arm(off);
    EXPECT_TRUE(touching(s, M_PI, 0).empty()) << off;
    EXPECT_TRUE(s.motion.search.apart.empty()) << off;
    EXPECT_EQ(noted(s), 0) << off;
  }
  const Scene s = arm("{detect: true, self: true}");
  EXPECT_TRUE(s.model.constraints.empty());  // what touches at the given pose is left out
  EXPECT_TRUE(touching(s, 0, 0).empty());
  // folded, the lower arm reaches the base and the lid; its neighbours are the upper arm and, beyond the wrist, the tool
  EXPECT_EQ(touching(s, M_PI, 0), (std::vector<Named>{{"base", "lower"}, {"lower", "lid"}})) << "folded";
  EXPECT_TRUE(touching(s, 0, M_PI).empty()) << "the tool turned into the lower arm";
}

TEST(SelfContacts, what_touches_from_the_start_is_counted) {
  const Scene s = arm("{detect: true, self: true}");
  EXPECT_EQ(noted(s), 1);  // the lid in the upper arm
  EXPECT_EQ(s.motion.search.apart.size(), 5u);  // base–upper, upper–lower, lower–tool, base–lid, and those
  EXPECT_TRUE(std::is_sorted(s.motion.search.apart.begin(), s.motion.search.apart.end()));
}

TEST(SelfContacts, what_a_constraint_joins_is_neighbour) {
  Model m;
  for (Index i = 0; i < 4; ++i) {
    Body b;
    b.name = std::to_string(i), b.parent = i == 0 || i == 3 ? ground : i - 1, b.mass = 1, b.inertia.setIdentity();
    b.shapes.push_back({Shape::Kind::sphere, {0.1, 0, 0}, {}, -1, {}});
    m.add(b);
  }
  Constraint loop;
  loop.kind = Constraint::Kind::point, loop.a.body = 2, loop.b.body = 0;
  Constraint between = loop;
  between.b.body = 3;  // another object
  m.constraints = {loop, between};
  using Pairs = std::vector<std::pair<Index, Index>>;
  EXPECT_EQ(neighbours(m, {0, 0, 0, 1}), (Pairs{{0, 1}, {0, 2}, {1, 2}}));
}

TEST(SelfContacts, other_values_are_refused) {
  try {
    (void)arm("{detect: true, self: neighbours}");
    ADD_FAILURE();
  } catch (const ModelError& e) {
    EXPECT_NE(std::string(e.what()).find("self"), std::string::npos) << e.what();
    EXPECT_NE(std::string(e.what()).find("neighbours"), std::string::npos) << e.what();
  }
}

}  // namespace
}  // namespace delassus::self_contacts_test
