// The sound texts that the fuzz of the loaders starts from.
#include "generators/spec.h"
#include "property_tests/campaigns/fuzz_judge.h"

namespace delassus {
namespace {

const char* const arm = R"(<?xml version="1.0" encoding="utf-8"?>
<!-- every joint type, every primitive -->
<robot name="arm">
  <link name="base_link">
    <inertial>
      <origin xyz="0.01 -0.02 0.03" rpy="0.1 0.2 -0.3"/>
      <mass value="4.5"/>
      <inertia ixx="0.05" ixy="0.001" ixz="-0.002" iyy="0.06" iyz="0.003" izz="0.07"/>
    </inertial>
  </link>
  <link name="upper">
    <inertial><origin xyz="0 0 0.2"/><mass value="1.25"/><inertia ixx="0.02" ixy="0" ixz="0" iyy="0.02" iyz="0" izz="0.01"/></inertial>
    <collision><geometry><cylinder radius="0.05" length="0.4"/></geometry></collision>
  </link>
  <link name="lower">
    <inertial><origin xyz="0 0 0.15" rpy="0 0.5 0"/><mass value="0.75"/><inertia ixx="0.011" ixy="0.0005" ixz="0" iyy="0.012" iyz="0" izz="0.006"/></inertial>
    <collision><origin xyz="0 0 0.1"/><geometry><box size="0.2 0.3 0.1"/></geometry></collision>
  </link>
  <link name="tip">
    <inertial><mass value="0.125"/><inertia ixx="0.001" ixy="0" ixz="0" iyy="0.001" iyz="0" izz="0.001"/></inertial>
    <collision><geometry><sphere radius="0.03"/></geometry></collision>
  </link>
  <link name="finger"><inertial><mass value="0.0625"/><inertia ixx="0.0001" ixy="0" ixz="0" iyy="0.0001" iyz="0" izz="0.0001"/></inertial></link>
  <joint name="shoulder" type="revolute">
    <origin xyz="0 0 0.25" rpy="0 0 1.5707963267948966"/>
    <parent link="base_link"/><child link="upper"/>
    <axis xyz="0 1 0"/>
    <limit lower="-1.5" upper="1.5" effort="100" velocity="3"/>
    <dynamics damping="0.1" friction="0.2"/>
  </joint>
  <joint name="elbow" type="continuous">
    <origin xyz="0 0.05 0.4"/><parent link="upper"/><child link="lower"/><axis xyz="0.6 0 0.8"/><dynamics armature="0.01"/>
  </joint>
  <joint name="mount" type="fixed"><origin xyz="0 0 0.3" rpy="0.4 0 0"/><parent link="lower"/><child link="tip"/></joint>
  <joint name="grip" type="prismatic">
    <origin xyz="0.02 0 0"/><parent link="tip"/><child link="finger"/><axis xyz="1 0 0"/>
    <limit lower="0" upper="0.04" effort="10" velocity="0.1"/>
  </joint>
</robot>
)";

const char* const gear = R"(<robot name="gear">
 <link name="a"><inertial><mass value="2"/><inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/></inertial></link>
 <link name="b"><inertial><mass value="1"/><inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/></inertial></link>
 <link name="c"><inertial><mass value="0.5"/><inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/></inertial></link>
 <joint name="j" type="continuous"><parent link="a"/><child link="b"/><axis xyz="0 0 1"/></joint>
 <joint name="k" type="continuous"><parent link="b"/><child link="c"/><origin xyz="1 0 0"/><axis xyz="0 0 1"/><mimic joint="j" multiplier="-2.5" offset="0.1"/></joint>
</robot>
)";

const char* const scene = R"(gravity: [0, 0, -9.81]
robots:
  - {name: arm, urdf: fuzz.urdf, base: fixed, pose: {xyz: [0, 0, 0.5], rpy: [0, 0, 0.3]}, joints: {shoulder: 0.2, elbow: -0.4}}
boxes:
  - {name: crate, mass: 2.5, size: [0.4, 0.3, 0.2], pose: {xyz: [1, 0, 0.1]}}
  - {name: block, mass: 1.5, size: [0.1, 0.2, 0.1], pose: {xyz: [2, 0, 0.05], rpy: [0, 0, 0.7]}}
ground: {z: 0, friction: 0.8}
constraints:
  - {kind: point, of: arm/tip, at: [0, 0, 0.1], to: world}
  - {kind: joint_friction, robot: arm, effort: 0.2}
contacts: detect
damping: 1.0e-4
)";

/// A fork of three joints, closed at its ends, with friction on the first.
std::string spec() {
  generators::Spec s;
  s.family = "fuzz";
  s.bodies.resize(3);
  s.bodies[1].parent = s.bodies[2].parent = 0;
  s.bodies[1].joint = generators::JointKind::spherical;
  s.bodies[1].dof = 3;
  s.bodies[2].armature_decade = -2;
  s.links.resize(1);
  s.links[0].bodies = {1, 2};
  s.joints.resize(1);
  s.joints[0].damping.kind = generators::DampingKind::zero;
  return generators::to_json(s);
}

const char* const mjcf = R"(<mujoco model="m">
  <compiler angle="radian"/>
  <worldbody>
    <body name="a" pos="0 0 1">
      <freejoint/>
      <inertial pos="0 0 0.1" mass="2" diaginertia="0.1 0.1 0.1"/>
      <body name="b" pos="0.2 0 0" quat="1 0.1 0 0">
        <joint name="j" type="hinge" axis="0 1 0" armature="0.01" damping="0.1"/>
        <geom type="capsule" size="0.05 0.1" mass="0.5"/>
        <body name="c" pos="0.2 0 0"><joint name="s" type="slide" axis="1 0 0"/><geom type="sphere" size="0.05" mass="0.25"/></body>
      </body>
      <body name="d" pos="-0.2 0 0"><joint name="k" type="hinge" axis="0 1 0"/><geom type="box" size="0.1 0.05 0.02" density="500"/></body>
    </body>
  </worldbody>
  <equality><connect body1="c" body2="d" anchor="0.1 0 0"/><joint joint1="j" joint2="k" polycoef="0 1 0 0 0"/></equality>
</mujoco>
)";

const char* const sdf = R"(<?xml version="1.0"?>
<sdf version="1.7">
  <model name="m">
    <link name="a"><inertial><mass>2</mass><inertia><ixx>0.1</ixx><iyy>0.1</iyy><izz>0.1</izz></inertia></inertial></link>
    <link name="b"><pose>0.5 0 0 0 0 0.1</pose><inertial><pose>0 0 0.1 0 0 0</pose><mass>1</mass><inertia><ixx>0.1</ixx><iyy>0.1</iyy><izz>0.1</izz></inertia></inertial>
      <collision name="c"><geometry><sphere><radius>0.1</radius></sphere></geometry></collision></link>
    <joint name="j" type="revolute"><parent>a</parent><child>b</child><axis><xyz>0 0 1</xyz><limit><lower>-1</lower><upper>1</upper></limit></axis></joint>
  </model>
</sdf>
)";

/// Frames, a nested model, every joint type, loops.
const char* const sdf_loops = R"(<?xml version="1.0"?>
<sdf version="1.9">
  <model name="m" canonical_link="base">
    <pose>0.1 0 0 0 0 0.2</pose>
    <frame name="f" attached_to="base"><pose>0 0.1 0.2 0.1 0.2 0.3</pose></frame>
    <link name="base"><inertial><mass>2</mass><inertia><ixx>0.1</ixx><iyy>0.12</iyy><izz>0.13</izz><ixy>0.01</ixy></inertia></inertial></link>
    <link name="a"><pose relative_to="ja">0 0 0.1 0 0.4 0</pose><inertial><pose>0.1 0 0 0 0.2 0</pose><mass>1.5</mass><inertia><ixx>0.02</ixx><iyy>0.03</iyy><izz>0.04</izz></inertia></inertial></link>
    <link name="b"><pose relative_to="a">0.3 0 0 0 0 0</pose><inertial><mass>0.5</mass><inertia><ixx>0.02</ixx><iyy>0.03</iyy><izz>0.04</izz></inertia></inertial></link>
    <link name="c"><pose>0.2 0.6 0 0 0 0</pose><inertial><mass>0.75</mass><inertia><ixx>0.02</ixx><iyy>0.03</iyy><izz>0.04</izz></inertia></inertial></link>
    <link name="g"><pose>0 -0.5 0 0 0 0</pose><inertial><mass>0.25</mass><inertia><ixx>0.02</ixx><iyy>0.03</iyy><izz>0.04</izz></inertia></inertial></link>
    <link name="h"><pose>0 -0.5 0.3 0 0 0</pose><inertial><mass>0.125</mass><inertia><ixx>0.02</ixx><iyy>0.03</iyy><izz>0.04</izz></inertia></inertial></link>
    <model name="n"><pose relative_to="f">0.4 0 0 0 0 0</pose>
      <link name="a"><inertial><mass>1</mass><inertia><ixx>0.02</ixx><iyy>0.03</iyy><izz>0.04</izz></inertia></inertial></link>
    </model>
    <joint name="ja" type="revolute"><pose relative_to="f"/><parent>base</parent><child>a</child><axis><xyz expressed_in="base">0 0.6 0.8</xyz></axis></joint>
    <joint name="jb" type="prismatic"><parent>a</parent><child>b</child><axis><xyz>1 0 0</xyz><limit><lower>-1</lower><upper>1</upper></limit></axis></joint>
    <joint name="jc" type="universal"><parent>base</parent><child>c</child><axis><xyz>1 0 0</xyz></axis><axis2><xyz>0 1 0</xyz></axis2></joint>
    <joint name="jg" type="revolute"><parent>base</parent><child>g</child><axis><xyz>0 0 1</xyz></axis></joint>
    <joint name="jh" type="continuous"><parent>base</parent><child>h</child><axis><xyz>0 0 1</xyz></axis></joint>
    <joint name="gear" type="gearbox"><parent>g</parent><child>h</child><gearbox_ratio>2</gearbox_ratio><gearbox_reference_body>base</gearbox_reference_body>
      <axis><xyz>0 0 1</xyz></axis><axis2><xyz>0 0 1</xyz></axis2></joint>
    <joint name="jn" type="ball"><parent>b</parent><child>n::a</child></joint>
    <joint name="pin" type="ball"><parent>c</parent><child>b</child></joint>
    <joint name="hinge" type="revolute"><parent>h</parent><child>c</child><axis><xyz>0 0.8 0.6</xyz></axis></joint>
  </model>
</sdf>
)";

}  // namespace

std::vector<FuzzText> fuzz_texts() {
  return {{"urdf", arm}, {"urdf", gear}, {"yaml", scene}, {"json", spec()}, {"xml", mjcf}, {"sdf", sdf}, {"sdf", sdf_loops}};
}

}  // namespace delassus
