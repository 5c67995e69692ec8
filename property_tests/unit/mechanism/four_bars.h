// Small linkages as scenes, for the tests of assembly and of rows on joints; what a scene says, and refuses.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <functional>
#include <sstream>
#include <string>
#include <vector>

#include "models/scene.h"
#include "property_tests/unit/way_in/temporary.h"

namespace delassus::four_bars {

inline std::string write(const std::string& name, const std::string& text) {
  const auto file = test::temporary(name);
  std::ofstream(file) << text;
  return file.string();
}

inline std::string link(const std::string& name) {
  return "<link name=\"" + name + "\"><inertial><mass value=\"1\"/><inertia ixx=\"0.1\" ixy=\"0\" ixz=\"0\" iyy=\"0.1\" iyz=\"0\" izz=\"0.1\"/></inertial></link>\n";
}

struct JointText {
  std::string name, parent, child, origin = "xyz=\"0 0 0\"", more = {}, limits = "lower=\"-9\" upper=\"9\"", type = "revolute", axis = "0 -1 0";
};

inline std::string joint(const JointText& j) {
  return "<joint name=\"" + j.name + "\" type=\"" + j.type + "\"><origin " + j.origin + "/><parent link=\"" + j.parent + "\"/><child link=\"" + j.child +
         "\"/><axis xyz=\"" + j.axis + "\"/><limit " + j.limits + " effort=\"1\" velocity=\"1\"/>" + j.more + "</joint>\n";
}

/// Crank 0.3 and coupler 0.8 on one side, rocker 0.6 on the other, pivots 1 m apart in the x z plane; angles from x to z.
/// f2 turns beside them.
inline std::string four_bar(const std::string& file, const JointText& j2 = {}, const JointText& j3 = {}, const std::string& j4_more = "") {
  JointText two = j2, three = j3;
  two.name = "j2", two.parent = "crank", two.child = "coupler", two.origin = "xyz=\"0.3 0 0\"" + (j2.origin[0] == 'r' ? " " + j2.origin : std::string());
  three.name = "j3", three.parent = "base", three.child = "rocker", three.origin = "xyz=\"1 0 0\"" + (j3.origin[0] == 'r' ? " " + j3.origin : std::string());
  return write(file, "<?xml version=\"1.0\"?>\n<robot name=\"r\">\n" + link("base") + link("crank") + link("coupler") + link("rocker") + link("f2") +
                         joint({"j1", "base", "crank"}) + joint(two) + joint(three) + joint({"j4", "base", "f2", "xyz=\"2 0 0\"", j4_more}) + "</robot>\n");
}

inline const std::string point_loop = "  - {kind: point, of: r/coupler, at: [0.8, 0, 0], to: r/rocker, to_at: [0.6, 0, 0]}\n";
inline const std::string hinge_loop =
    "  - {kind: hinge, of: r/coupler, at: [0.8, 0, 0], axes: {z: [0, 1, 0]}, to: r/rocker, to_at: [0.6, 0, 0], to_axes: {z: [0, 1, 0]}}\n";

inline Scene scene_of(const std::string& urdf, const std::string& joints, const std::string& constraints, const std::string& more = "") {
  return load_scene(write("loop_closing.yaml", "robots:\n  - {name: r, urdf: " + urdf + ", base: fixed, joints: {" + joints + "}}\nconstraints:\n" + constraints + more));
}

inline bool has_warning(const Scene& s, const std::string& kind) {
  return std::any_of(s.warnings.begin(), s.warnings.end(), [&](const Warning& w) { return w.kind == kind; });
}

inline bool has_note(const Scene& s, const std::string& part) {
  return std::any_of(s.notes.begin(), s.notes.end(), [&](const std::string& n) { return n.find(part) != std::string::npos; });
}

inline std::string refusal(const std::function<void()>& load) {
  try {
    load();
  } catch (const ModelError& e) {
    return e.what();
  }
  return "";
}

inline void expect_refused(const std::function<void()>& load, const std::vector<std::string>& parts) {
  const std::string text = refusal(load);
  EXPECT_NE(text, "") << "not refused";
  for (const std::string& part : parts) EXPECT_NE(text.find(part), std::string::npos) << part << " is not in: " << text;
}

inline std::string text(double x) {
  std::ostringstream s;
  s.precision(17);
  s << x;
  return s.str();
}

}  // namespace delassus::four_bars
