// What the tests of the MJCF reader share: files, what is read from them, and two robots that have a bit of everything.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <string>

#include "models/formats/mjcf.h"
#include "property_tests/unit/way_in/mjcf_compare.h"
#include "property_tests/unit/way_in/temporary.h"

namespace delassus::mjcf_test {

inline std::string write(const std::string& name, const std::string& text) {
  const auto file = delassus::test::temporary(name);
  std::ofstream(file) << text;
  return file.string();
}

inline std::string mjcf(const std::string& name, const std::string& text) {
  return write(name + ".xml", "<mujoco model=\"" + name + "\">" + text + "</mujoco>");
}

inline RobotOptions options(const std::string& file) {
  RobotOptions o;
  o.file = file;
  o.robot = "r";
  return o;
}

struct Read {
  Model model;
  Robot robot;
  VectorX<double> q;  ///< the start pose
};

inline Read read(const RobotOptions& o) {
  Read out;
  out.robot = add_mjcf(out.model, o);
  out.q = neutral(out.model);
  for (const auto& [body, values] : out.robot.start)
    for (std::size_t k = 0; k < values.size(); ++k) out.q[out.model.first_q[static_cast<std::size_t>(body)] + static_cast<Index>(k)] = values[k];
  return out;
}

// Rotated inertials, several joints per body with anchors off the origin, ref, every joint type, armature, merged links.
inline const char* const tree = R"(
<compiler angle="radian"/>
<worldbody>
 <geom type="plane" size="1 1 1"/>
 <body name="base" pos="0.3 -0.2 0.9" quat="0.9 0.1 -0.3 0.2"><freejoint name="float"/>
  <inertial pos="0.01 0.02 -0.03" quat="0.8 0.3 0.1 -0.4" mass="3" diaginertia="0.03 0.04 0.05"/>
  <body name="arm" pos="0.1 0.2 0.3" euler="0.3 -0.4 0.5">
   <joint name="yaw" type="hinge" axis="0.1 0.2 0.9" pos="0.05 -0.03 0.02" ref="0.4" armature="0.01" range="-1 2" limited="true" damping="0.3" frictionloss="0.2"/>
   <joint name="reach" type="slide" axis="1 0.5 0" pos="0.4 0.1 0.2" ref="-0.1" armature="0.2"/>
   <joint name="roll" type="hinge" axis="1 -1 0.3" pos="-0.02 0.06 0.01"/>
   <inertial pos="0.1 0 0.02" mass="1.2" fullinertia="0.011 0.012 0.013 0.001 -0.002 0.003"/>
   <body name="plate" pos="0 0.1 0" euler="0 0.7 0"><inertial pos="0 0.01 0" quat="0.7 0.1 0.2 0.3" mass="0.3" diaginertia="0.001 0.002 0.0025"/>
    <geom name="pad" type="box" size="0.1 0.05 0.02" pos="0.01 0.02 0.03" euler="0.1 0.2 0.3" friction="0.7" mass="0"/>
   </body>
   <body name="hand" pos="0.3 0 0.1"><joint name="wrist" type="ball" pos="0.01 0.02 0.03" armature="0.002"/>
    <inertial pos="0.02 0 0.1" mass="0.5" diaginertia="0.002 0.003 0.004"/>
    <geom type="sphere" size="0.03" mass="0"/></body>
  </body>
  <body name="leg" pos="-0.1 0 -0.2"><joint name="knee" axis="0 1 0"/><geom type="capsule" size="0.03 0.2" pos="0 0 -0.1" density="900"/>
   <body name="shin" pos="0 0 -0.3"><joint name="ankle" axis="0 1 0" ref="0.3"/><geom type="cylinder" size="0.03 0.1" euler="0.2 0 0"/></body></body>
 </body>
 <body name="post" pos="1 0 0.5" euler="0 0 0.6"><joint name="swing" axis="0 0.6 0.8" pos="0 0 0.1"/><geom type="ellipsoid" size="0.05 0.06 0.07"/></body>
</worldbody>)";

inline const char* const closures = R"(
<tendon><fixed name="t1"><joint joint="knee" coef="0.5"/><joint joint="swing" coef="-2"/></fixed>
 <fixed name="t2"><joint joint="roll" coef="1.5"/><joint joint="knee" coef="3"/></fixed></tendon>
<equality>
 <connect name="pin" body1="hand" body2="shin" anchor="0.1 0.2 0.3"/>
 <connect body1="shin" anchor="0.01 0.02 0.03"/>
 <weld name="clamp" body1="plate" body2="post" relpose="0.1 0.2 0.3 0.9 0.1 0.3 -0.2" torquescale="0.5"/>
 <weld body1="hand" body2="leg"/>
 <joint name="gear" joint1="ankle" joint2="yaw" polycoef="0.2 -1.5 0 0 0"/>
 <joint name="cam" joint1="knee" joint2="yaw" polycoef="0.1 0.5 2 0 1"/>
 <joint name="held" joint1="swing" polycoef="0.3 0 0 0 0"/>
 <joint name="off" joint1="knee" joint2="ankle" active="false"/>
 <tendon name="rope" tendon1="t1" tendon2="t2" polycoef="0 0.7 0 0 0"/>
 <tendon name="cord" tendon1="t1"/>
</equality>)";

inline const char* const fourbar = R"(<compiler angle="degree"/><worldbody>
 <body name="crank" pos="0 0 1" euler="10 20 30"><joint name="j1" axis="0 1 0" range="-90 180" limited="true"/><geom type="capsule" size="0.01" fromto="0 0 0 0 0 0.2"/>
  <body name="rod" pos="0 0 0.2"><joint name="j2" axis="0 1 0" ref="30"/><geom type="capsule" size="0.01" fromto="0 0 0 0.4 0 0.1"/>
   <body name="rocker" pos="0.4 0 0.1"><joint name="j3" axis="0 1 0"/><geom type="capsule" size="0.01" fromto="0 0 0 0.05 0 -0.3"/></body></body></body>
</worldbody><equality><connect body1="rocker" anchor="0.05 0 -0.3"/></equality>
<keyframe><key name="bent" qpos="0.1 0.2 0.3"/></keyframe>)";

inline void expect_agreement(const std::string& what, const RobotOptions& o, const Read& r) {
  for (unsigned seed = 0; seed < 5; ++seed) {
    const unit::MjcfRatios x = unit::compare_mjcf(o, r.model, r.robot, seed);
    std::printf("  %-20s M %.2g  J %.2g (%d rows)\n", what.c_str(), x.M, x.J, static_cast<int>(x.rows));
    EXPECT_LT(x.M, 30) << what << " seed " << seed;
    EXPECT_LT(x.J, 30) << what << " seed " << seed;
  }
}

inline Body& body(Model& m, const char* name) { return m.bodies[static_cast<std::size_t>(m.find(std::string("r/") + name))]; }
inline Constraint& constraint(Model& m, const char* name) {
  return *std::find_if(m.constraints.begin(), m.constraints.end(), [&](const Constraint& c) { return c.name == std::string("r/") + name; });
}

inline bool said(const std::vector<std::string>& notes, const std::string& words) {
  return std::any_of(notes.begin(), notes.end(), [&](const std::string& n) { return n.find(words) != std::string::npos; });
}

inline std::string refusal(const std::string& file) {
  try {
    static_cast<void>(read(options(file)));
  } catch (const ModelError& e) {
    return e.what();
  }
  return "";
}

}  // namespace delassus::mjcf_test
