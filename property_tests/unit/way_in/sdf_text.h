// What the tests of the SDF reader share: small files, and a robot read from one.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "algorithms/mechanism/kinematics.h"
#include "models/robot.h"
#include "property_tests/unit/way_in/temporary.h"

namespace delassus::unit {

inline std::string write_sdf(const std::string& name, const std::string& text) {
  const std::filesystem::path file = test::temporary(name);
  std::filesystem::create_directories(file.parent_path());
  std::ofstream(file) << text;
  return file.string();
}

inline std::string sdf(const std::string& inside) { return "<?xml version='1.0'?>\n<sdf version='1.9'>\n<model name='m'>\n" + inside + "\n</model>\n</sdf>\n"; }

inline std::string sdf_inertial(double mass, const std::string& pose = "") {
  return "<inertial>" + (pose.empty() ? "" : "<pose>" + pose + "</pose>") + "<mass>" + std::to_string(mass) +
         "</mass><inertia><ixx>0.02</ixx><iyy>0.03</iyy><izz>0.04</izz><ixy>0.001</ixy><ixz>-0.002</ixz><iyz>0.003</iyz></inertia></inertial>";
}

inline Robot read_robot(const std::string& file, Model& model, RobotOptions o = {}) {
  o.file = file, o.robot = "r";
  return add_robot(model, o);
}

/// Whether this program was built with libsdformat.
inline bool sdf_is_read() {
  static const bool known = [] {
    Model m;
    try {
      (void)read_robot(write_sdf("sdf/probe.sdf", sdf("<link name='a'>" + sdf_inertial(1) + "</link>")), m);
    } catch (const ModelError& e) {
      return std::string(e.what()).find("without libsdformat") == std::string::npos;
    }
    return true;
  }();
  return known;
}

#define NEEDS_SDF \
  if (!unit::sdf_is_read()) GTEST_SKIP() << "built without libsdformat"

/// The neutral configuration, then what the file says.
inline VectorX<double> start(const Model& model, const Robot& robot) {
  VectorX<double> q = neutral(model);
  for (const auto& [body, values] : robot.start)
    for (std::size_t k = 0; k < values.size(); ++k) q[model.first_q[static_cast<std::size_t>(body)] + static_cast<Index>(k)] = values[k];
  return q;
}

}  // namespace delassus::unit
