// SPDX-License-Identifier: Apache-2.0
// Bodies and axes of a URDF file: where each surface and joint is with all joints at 0, computed by
// hand, and what a machine file cannot contain, by line.
#include "config/init/urdf.hpp"

#include <gtest/gtest.h>

#include <string>

#include "config/init/write_machine.hpp"

namespace axg {
namespace {

// A slide along -Y of a base that is turned by a quarter about Z; on it, behind a fixed bracket
// without a surface, a rotary table of two meshes that share one file.
const std::string kRobot = R"(<?xml version="1.0"?>
<robot name="mill">
  <link name="world"/>
  <joint name="stand" type="fixed">
    <parent link="world"/> <child link="base"/>
    <origin xyz="0.1 0 0" rpy="0 0 1.57079632679"/>
  </joint>
  <link name="base">
    <visual><geometry><mesh filename="package://m/v/base.dae"/></geometry></visual>
    <collision>
      <origin xyz="0 .02 0"/>
      <geometry><mesh filename="package://m/meshes/base.STL" scale="0.001 0.001 0.001"/></geometry>
    </collision>
  </link>
  <joint name="x_joint" type="prismatic">
    <parent link="base"/> <child link="slide"/>
    <origin xyz="0 0 0.5"/> <axis xyz="-2 0 0"/>
    <limit lower="-0.2" upper="0.3" effort="1" velocity="0.5"/>
  </joint>
  <link name="slide">
    <visual><origin xyz="0 0 1"/><geometry><box size="1 2 3"/></geometry></visual>
    <visual><geometry><cylinder radius="0.05" length="0.2"/></geometry></visual>
  </link>
  <joint name="bracket_joint" type="fixed">
    <parent link="slide"/> <child link="bracket"/> <origin xyz="1 0 0" rpy="3.14159265359 0 0"/>
  </joint>
  <link name="bracket"/>
  <joint name="turn" type="continuous">
    <parent link="bracket"/> <child link="table"/> <axis xyz="0 0 1"/>
  </joint>
  <link name="table">
    <visual><geometry><mesh filename="../meshes/table.stl"/></geometry></visual>
    <visual><origin xyz="0 0 0.4"/><geometry><mesh filename="table.stl"/></geometry></visual>
  </link>
</robot>
)";

bool has_robot_file(const std::string& name) {
    return name == "meshes/base.STL" || name == "table.stl" || name == "base.dae";
}

/// kRobot with one text in the place of another.
std::string robot_with(const std::string& from, const std::string& to) {
    std::string text = kRobot;
    const std::size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return text.replace(at, from.size(), to);
}

std::string urdf_faults(const std::string& text) {
    std::string out;
    for (const ConfigFault& fault : read_urdf(text, "m.urdf", has_robot_file).faults) {
        out += to_string(fault) + '\n';
    }
    return out;
}

void expect_near(Vec3d a, Vec3d b, const char* what) {
    EXPECT_NEAR(a.x, b.x, 1e-6) << what;
    EXPECT_NEAR(a.y, b.y, 1e-6) << what;
    EXPECT_NEAR(a.z, b.z, 1e-6) << what;
}

TEST(Urdf, EverySurfaceIsABodyWhereTheFramesPutIt) {
    const UrdfMachine machine = read_urdf(kRobot, "m.urdf", has_robot_file);
    ASSERT_EQ(urdf_faults(kRobot), "");
    ASSERT_EQ(machine.roles.size(), 4U);
    const RoleGuess &base = machine.roles[0], &slide = machine.roles[1], &table = machine.roles[2],
                    &second = machine.roles[3];
    EXPECT_EQ(base.parent, kNoParent);
    EXPECT_EQ(base.axis, "");
    expect_near(base.at_mm, {80, 0, 0}, "y of the base is -x of the machine");
    expect_near(base.rotate_deg, {0, 0, 90}, "base");
    ASSERT_EQ(machine.meshes.size(), 2U) << "one file twice in one unit is one mesh";
    EXPECT_EQ(machine.meshes[0].file, "meshes/base.STL");
    EXPECT_EQ(machine.meshes[0].unit, LengthUnit::mm);
    EXPECT_EQ(machine.meshes[1].unit, LengthUnit::m);
    EXPECT_EQ(slide.axis, "X");
    EXPECT_EQ(slide.axis_note, "joint x_joint, m.urdf:15");
    expect_near(slide.direction, {0, -1, 0}, "of length 1");
    EXPECT_EQ(slide.file, kNoFile);
    EXPECT_EQ(slide.shapes,
              "{box_mm: [1000, 2000, 3000], at_mm: [0, 0, -500]}, "
              "{cylinder: {radius_mm: 50, height_mm: 200}, at_mm: [0, 0, -100]}");
    EXPECT_EQ(table.parent, 1U) << "the bracket has no surface, and its joint is fixed";
    EXPECT_EQ(table.axis, "J2");
    expect_near(table.direction, {0, 0, -1}, "the bracket hangs head down");
    expect_near(table.pivot_mm, {100, 1000, 500}, "table");
    EXPECT_EQ(second.parent, 2U);
    EXPECT_EQ(second.axis, "");
    EXPECT_EQ(second.name, "table_2");
    expect_near(second.at_mm, {100, 1000, 100}, "0.4 m up for the table is down");
}

TEST(Urdf, LimitsAreInMmAndDegrees) {
    const UrdfMachine machine = read_urdf(kRobot, "m.urdf", has_robot_file);
    ASSERT_EQ(machine.axes.axes.size(), 2U);
    const IniAxis &x = machine.axes.axes[0], &turn = machine.axes.axes[1];
    EXPECT_DOUBLE_EQ(*x.min, -200);
    EXPECT_DOUBLE_EQ(*x.max, 300);
    EXPECT_DOUBLE_EQ(*x.speed, 500);
    EXPECT_FALSE(x.is_rotary || x.acceleration || x.braking);
    EXPECT_TRUE(turn.is_rotary && turn.is_unlimited);
    EXPECT_FALSE(turn.speed);
    const UrdfMachine revolute = read_urdf(robot_with("<axis xyz=\"0 0 1\"/>",
                                                      "<limit lower=\"0\" upper=\"1.57079632679\"/>"
                                                      "<axis xyz=\"0 0 1\"/>"),
                                           "m.urdf", has_robot_file);
    EXPECT_TRUE(revolute.axes.axes.at(1).is_unlimited) << "continuous, whatever its limit";
}

// What URDF does not state is marked, each by name; what it states is not.
TEST(Urdf, OnlyWhatTheFileDoesNotStateIsAGuess) {
    const UrdfMachine machine = read_urdf(kRobot, "m.urdf", has_robot_file);
    const std::string text = machine_file_text(
        "m", std::vector<SurveyedMesh>(machine.meshes.size()), machine.roles, machine.axes);
    EXPECT_NE(text.find("  X: {slot: 0, kind: linear, travel_mm: [-200, 300], speed_mm_min: 30000, "
                        "acceleration_mm_s2: 1000, jerk_mm_s3: none, stopping_mm_s2: 800, "
                        "position_error_mm: 0.001, following_error_mm: 0}  # GUESS: stopping, "
                        "position_error, following_error, acceleration, jerk\n"),
              std::string::npos)
        << text;
    EXPECT_NE(text.find("    axis: J2  # joint turn, m.urdf:28\n    direction: [0, 0, -1]\n    "
                        "pivot_mm: [100, 1000, 500]\n"),
              std::string::npos)
        << text;
    EXPECT_EQ(text.find("LinuxCNC"), std::string::npos) << text;
    const std::size_t bodies = text.find("\nbodies:");
    EXPECT_EQ(text.substr(bodies, text.find("\npairs:") - bodies).find("GUESS"), std::string::npos);
}

TEST(Urdf, AMimicFollowsTheSameAxis) {
    const std::string mimic = robot_with(
        "<joint name=\"turn\" type=\"continuous\">",
        "<joint name=\"turn\" type=\"prismatic\"><mimic joint=\"x_joint\" multiplier=\"-1\"/>");
    const UrdfMachine machine = read_urdf(mimic, "m.urdf", has_robot_file);
    ASSERT_EQ(urdf_faults(mimic), "");
    ASSERT_EQ(machine.axes.axes.size(), 1U);
    EXPECT_EQ(machine.roles[2].axis, "X");
    expect_near(machine.roles[2].direction, {0, 0, 1}, "the other way");
}

TEST(Urdf, WhatAMachineFileCannotContainIsNamedWithItsLine) {
    const auto fault = [](const std::string& from, const std::string& to) {
        return urdf_faults(robot_with(from, to));
    };
    EXPECT_EQ(fault("\"continuous\"", "\"floating\""),
              "m.urdf:28: joint turn.type: invalid value (found \"floating\", expected fixed, "
              "revolute, continuous or prismatic). Replace this joint.\n");
    EXPECT_EQ(
        fault("scale=\"0.001 0.001 0.001\"", "scale=\"1 1 -1\""),
        "m.urdf:12: link base.collision.mesh.scale: invalid value (found \"1 1 -1\", expected "
        "one scale above 0 for x, y and z). Stretch or mirror the mesh itself.\n");
    EXPECT_EQ(fault("scale=\"0.001 0.001 0.001\"", "scale=\"2 2 2\""),
              "m.urdf:12: link base.mesh.scale: invalid value (found 2, expected 1, 0.001, 0.0254 "
              "or 0.000001: a file in m, mm, inch or um).\n");
    EXPECT_EQ(fault("meshes/base.STL", "meshes/base.dae"),
              "m.urdf:12: link base.mesh.filename: invalid value (found "
              "\"package://m/meshes/base.dae\", expected an STL file). Convert the mesh and change "
              "its name here.\n");
    EXPECT_EQ(fault("<box size=\"1 2 3\"/>", "<capsule radius=\"1\" length=\"1\"/>"),
              "m.urdf:21: link slide.visual.geometry: invalid value (found \"capsule\", expected a "
              "mesh, a box, a cylinder or a sphere).\n");
    EXPECT_EQ(fault("upper=\"0.3\"", "upper=\"-0.2\""),
              "m.urdf:18: joint x_joint.limit: invalid value (found lower -0.2, upper -0.2, "
              "expected lower below upper). Give a joint that cannot move the type fixed.\n");
    EXPECT_EQ(fault("rpy=\"0 0 1.57079632679\"", "rpy=\"0 0 ${pi/2}\""),
              "m.urdf:6: joint stand.origin.rpy: invalid value (found \"0 0 ${pi/2}\", expected 3 "
              "numbers within 1000).\n");
    EXPECT_EQ(fault("<link name=\"world\"/>", "<xacro:include filename=\"a\"/>"),
              "m.urdf:3: robot: invalid value (found \"xacro:include\", expected a URDF file). "
              "Write one with xacro FILE > robot.urdf.\n");
    EXPECT_EQ(fault("<parent link=\"bracket\"/>", "<parent link=\"brackets\"/>"),
              "m.urdf:28: joint turn.parent: invalid value (found \"brackets\", expected a link of "
              "this file).\n");
    EXPECT_NE(fault("<parent link=\"world\"/>", "<parent link=\"table\"/>"), "") << "a circle";
    EXPECT_NE(urdf_faults("<robot><link name='a'></robot>"), "");
    EXPECT_NE(urdf_faults(""), "");
    EXPECT_NE(urdf_faults("<sdf/>"), "");
}

// Upright, roll and yaw turn about one line: the angles still lead to the same placement.
TEST(Urdf, AQuarterAboutYKeepsItsRoll) {
    const UrdfMachine machine =
        read_urdf(robot_with("rpy=\"0 0 1.57079632679\"", "rpy=\"0.5 1.57079632679 0.2\""),
                  "m.urdf", has_robot_file);
    ASSERT_FALSE(machine.roles.empty());
    const double roll = (0.5 - 0.2) * 180 / 3.14159265358979;  // yaw turns it back
    expect_near(machine.roles[0].rotate_deg, {roll, 90, 0}, "roll and pitch only");
}

}  // namespace
}  // namespace axg
