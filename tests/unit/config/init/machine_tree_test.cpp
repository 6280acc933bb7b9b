// SPDX-License-Identifier: Apache-2.0
// ctest-labels: data
// The machine.yml of a QtPyVCP screen: what it states is in the machine file without a guess, and
// what is wrong with it is named by line and key. The real one against the machine file that was
// written by hand from its program.
#include "config/init/machine_tree.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "config/compiled/compiled_machine.hpp"
#include "config/init/write_machine.hpp"

namespace axg {
namespace {

const std::vector<std::string> kFiles{"bed.stl", "head.stl", "plate.stl", "x.stl"};
const std::string kTree = R"(root:
  id: bed
  model: "machine/bed.stl"
  type: table
  position: [0, 0, 0, 0, 0, 0]
  origin: [0, 0, 0]
  axis: null
  child_x:
    id: x
    model: machine/x.stl
    position: [1, 2, 3, 0, 0, 0]
    axis: x
    child_plate:
      id: rotary plate
      model: plate.stl
      origin: [0, 0, -18]
      axis: c
  child_head:
    id: head
    model: head.stl
    axis: Z
)";

MachineTree read(const std::string& text, double length_mm = 25.4) {
    return read_machine_tree(text, "machine.yml", kFiles, length_mm);
}

TEST(MachineTree, HasParentsAxesPlacesAndSides) {
    const MachineTree tree = read(kTree);
    ASSERT_TRUE(tree.faults.empty()) << to_string(tree.faults[0]);
    ASSERT_EQ(tree.roles.size(), 4U);
    const RoleGuess &bed = tree.roles[0], &x = tree.roles[1], &plate = tree.roles[2],
                    &head = tree.roles[3];
    EXPECT_EQ(bed.parent, kNoParent);
    EXPECT_EQ(bed.axis, '\0');
    EXPECT_EQ(x.parent, 0U);
    EXPECT_EQ(x.axis, 'X');
    EXPECT_TRUE(x.is_table_side && plate.is_table_side);
    EXPECT_NEAR(x.at_mm.z, 76.2, 1e-12);
    EXPECT_EQ(plate.parent, 1U);
    EXPECT_EQ(plate.name, "rotary_plate");
    EXPECT_NEAR(plate.pivot_mm.z, -457.2, 1e-12);
    EXPECT_EQ(plate.file, 2U);
    EXPECT_EQ(head.axis, 'Z');
    EXPECT_FALSE(head.is_table_side || head.parent != 0U);
}

// A router: X carries Y carries Z.
TEST(MachineTree, WhatCarriesTheSpindleIsOnItsSide) {
    std::string text = kTree;
    text.replace(text.find("axis: c"), 7, "axis: z");
    const MachineTree tree = read(text);
    ASSERT_TRUE(tree.faults.empty());
    EXPECT_FALSE(tree.roles[1].is_table_side || tree.roles[2].is_table_side);
}

TEST(MachineTree, AFaultNamesItsLineAndKey) {
    const struct {
        const char *from, *to, *wanted;
    } edits[] = {
        {"axis: x", "axis: q", "machine.yml:12: root.child_x.axis: "},
        {"axis: x", "axis: xy", "machine.yml:12: root.child_x.axis: "},
        {"model: head.stl", "model: none.stl", "machine.yml:19: root.child_head.model: "},
        {"model: head.stl", "model: x.stl", "root.child_head.model: "},
        {"[1, 2, 3, 0, 0, 0]", "[1, 2, 3, 0, 0, 90]", "machine.yml:11: root.child_x.position: "},
        {"[1, 2, 3, 0, 0, 0]", "[1, 2, 3]", "machine.yml:11: root.child_x.position: "},
        {"[0, 0, -18]", "[0, 0, .nan]", "machine.yml:16: root.child_x.child_plate.origin"},
        {"      origin: [0, 0, -18]\n", "", "root.child_x.child_plate.origin: "},
        {"root:", "machine:", "machine.yml:1: root: "},
        {"  child_head:", "  child_head: 3\n  child_tail:", "root.child_head: "},
    };
    for (const auto& edit : edits) {
        std::string text = kTree;
        text.replace(text.find(edit.from), std::string(edit.from).size(), edit.to);
        const MachineTree tree = read(text);
        ASSERT_FALSE(tree.faults.empty()) << edit.to;
        EXPECT_NE(to_string(tree.faults[0]).find(edit.wanted), std::string::npos)
            << to_string(tree.faults[0]);
    }
    EXPECT_FALSE(read("").faults.empty());
    EXPECT_FALSE(read("root: [").faults.empty());
}

TEST(MachineTree, OfARealMachineIsTheFileThatWasWrittenByHand) {
    const std::string folder = std::string(AXG_SHARED_DATA) + "/machines/probe-basic-xyzac";
    std::ifstream file(folder + "/machine.yml");
    if (!file) {
        GTEST_SKIP() << "no " << folder << ": set AXG_SHARED_DATA";
    }
    const std::string text{std::istreambuf_iterator<char>(file), {}};
    std::vector<std::string> files;
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
        files.push_back(entry.path().filename().string());
    }
    const MachineTree tree = read_machine_tree(text, "machine.yml", files, 25.4);
    ASSERT_TRUE(tree.faults.empty()) << to_string(tree.faults[0]);
    Machine machine;
    const auto faults = load_machine(
        std::string(AXG_SOURCE_DIR) + "/config/machines/probe-basic-xyzac.yaml", machine);
    ASSERT_TRUE(faults.empty()) << to_string(faults[0]);
    ASSERT_EQ(tree.roles.size() + 1, machine.bodies.size()) << "the tool is no part of it";
    for (const RoleGuess& role : tree.roles) {
        const auto body = std::find_if(machine.bodies.begin(), machine.bodies.end(),
                                       [&](const Body& one) { return one.name == role.name; });
        ASSERT_NE(body, machine.bodies.end()) << role.name;
        // The frame itself, which the file by hand leaves to be the parent of all.
        const bool is_on_frame = role.parent == kNoParent || role.parent == 0;
        EXPECT_EQ(is_on_frame, body->parent == kNoIndex) << role.name;
        if (!is_on_frame) {
            EXPECT_EQ(tree.roles[role.parent].name, machine.bodies[body->parent].name);
        }
        const Joint& joint = body->joint;
        EXPECT_EQ(role.axis == '\0', joint.axis == kNoIndex) << role.name;
        EXPECT_EQ(role.at_mm, (Vec3d{body->at.t[0], body->at.t[1], body->at.t[2]})) << role.name;
        if (joint.axis != kNoIndex) {
            EXPECT_EQ(std::string(1, role.axis), machine.axes[joint.axis].name);
            const Vec3d way = joint.direction;
            EXPECT_EQ(role.is_table_side, way.x + way.y + way.z < 0) << role.name;
        }
        if (role.axis == 'A' || role.axis == 'C') {
            EXPECT_EQ(role.pivot_mm, joint.pivot_mm) << role.name;
        }
    }
}

}  // namespace
}  // namespace axg
