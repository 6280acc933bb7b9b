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
    type: linear
    position: [1, 2, 3, 0, 0, 0]
    axis: x
    child_plate:
      id: rotary plate
      model: plate.stl
      type: angular
      position: [0, 1, -18, 0, 0, 0]
      origin: [0, 1, -18]
      axis: c
  child_head:
    id: head
    model: head.stl
    type: linear
    position: [0, 0, 0, 0, 0, 0]
    axis: z
)";

MachineTree read(const std::string& text, double length_mm = 25.4) {
    return read_machine_tree(text, "machine.yml", kFiles, length_mm);
}

/// kTree with one text in the place of another.
std::string edited(const std::string& from, const std::string& to) {
    std::string text = kTree;
    const std::size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return text.replace(at, from.size(), to);
}

/// The machine file that init writes from a tree; empty after a fault of the tree.
std::string written(const std::string& text) {
    MachineTree tree = read(text, 1);
    EXPECT_TRUE(tree.faults.empty()) << to_string(tree.faults[0]);
    std::vector<SurveyedMesh> meshes(kFiles.size());
    for (std::size_t i = 0; i < kFiles.size(); ++i) {
        meshes[i].source.file = kFiles[i];
    }
    return tree.faults.empty() ? machine_file_text("m", meshes, tree.roles) : "";
}

bool has(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
}

TEST(MachineTree, HasParentsAxesPlacesAndSides) {
    const MachineTree tree = read(kTree);
    ASSERT_TRUE(tree.faults.empty()) << to_string(tree.faults[0]);
    ASSERT_EQ(tree.roles.size(), 4U);
    const RoleGuess &bed = tree.roles[0], &x = tree.roles[1], &plate = tree.roles[2],
                    &head = tree.roles[3];
    EXPECT_EQ(bed.parent, kNoParent);
    EXPECT_EQ(bed.axis, "");
    EXPECT_EQ(x.parent, 0U);
    EXPECT_EQ(x.axis, "X");
    EXPECT_TRUE(x.is_table_side && plate.is_table_side);
    EXPECT_NEAR(x.at_mm.z, 76.2, 1e-12);
    EXPECT_EQ(plate.parent, 1U);
    EXPECT_EQ(plate.name, "rotary_plate");
    EXPECT_NEAR(plate.pivot_mm.z, -457.2, 1e-12);
    EXPECT_EQ(plate.pivot_doubt, "");
    EXPECT_EQ(plate.file, 2U);
    EXPECT_EQ(head.axis, "Z");
    EXPECT_FALSE(head.is_table_side || head.parent != 0U);
}

// QtPyVCP translates by position, turns, and translates back; it never uses origin.
TEST(MachineTree, APartTurnsAboutItsPosition) {
    EXPECT_TRUE(has(written(kTree), "    pivot_mm: [0, 1, -18]\n"));
    EXPECT_TRUE(
        has(written(edited("      origin: [0, 1, -18]\n", "")), "    pivot_mm: [0, 1, -18]\n"));
    const std::string other = written(edited("[0, 1, -18]", "[0, 0, 4]"));
    EXPECT_TRUE(has(other,
                    "    pivot_mm: [0, 1, -18]  # GUESS: position in the tree, about which QtPyVCP "
                    "turns it; origin there is another point, [0, 0, 4] mm\n"))
        << other;
}

TEST(MachineTree, AMinusReversesTheMotion) {
    const std::string minus = written(edited("axis: z", "axis: \"-z\""));
    EXPECT_TRUE(has(minus, "    axis: Z\n    direction: [0, 0, -1]\n")) << minus;
    EXPECT_TRUE(has(written(edited("axis: x", "axis: -x")), "    direction: [-1, 0, 0]\n"));
    EXPECT_TRUE(has(written(edited("axis: c", "axis: -b")), "    direction: [0, -1, 0]\n"));
    // Next to it, a letter without a minus states a direction too, and that a table moves so is
    // doubted.
    EXPECT_TRUE(has(minus,
                    "    axis: C\n    direction: [0, 0, 1]  # GUESS: as the tree states it; what "
                    "carries the workpiece moves against its command\n"))
        << minus;
}

// As Probe Basic's: the drawing moves the table along with the tool, and no machine does.
TEST(MachineTree, WithoutAnyMinusTheTablesDirectionsAreGuessed) {
    const std::string text = written(kTree);
    EXPECT_TRUE(has(text, "    axis: Z\n    direction: [0, 0, 1]\n")) << text;
    const std::string doubt =
        "  # GUESS: what carries the workpiece moves against its command; the tree has no minus, "
        "and QtPyVCP draws it moving with its command\n";
    EXPECT_TRUE(has(text, "    axis: X\n    direction: [-1, 0, 0]" + doubt)) << text;
    EXPECT_TRUE(has(text, "    axis: C\n    direction: [0, 0, -1]" + doubt)) << text;
}

// QtPyVCP lets such a part rest: what a person meant is a guess.
TEST(MachineTree, AnotherSpellingIsDoubted) {
    const struct {
        const char *from, *to, *direction;
    } edits[] = {
        {"axis: z", "axis: Z", "[0, 0, 1]"},
        {"axis: z", "axis: +z", "[0, 0, 1]"},
        {"axis: z", "axis: -Z", "[0, 0, -1]"},
        {"axis: z", "axis: w", "[0, 0, -1]"},
        {"axis: x", "axis: u", "[-1, 0, 0]"},
        {"axis: x", "axis: -v", "[0, -1, 0]"},
        {"    type: linear\n    position: [0", "    position: [0", "[0, 0, 1]"},
        {"    type: linear\n    position: [0", "    type: Linear\n    position: [0", "[0, 0, 1]"},
    };
    for (const auto& edit : edits) {
        const std::string text = written(edited(edit.from, edit.to));
        EXPECT_TRUE(has(text, "    direction: " + std::string(edit.direction) +
                                  "  # GUESS: QtPyVCP does not move a part with axis "))
            << edit.to << '\n'
            << text;
    }
    EXPECT_FALSE(has(written(edited("axis: z", "axis: None")), "axis: Z")) << "it stands still";
}

// A router: X carries Y carries Z. A knee: Z carries the table, against its command.
TEST(MachineTree, WhatCarriesTheSpindleIsOnItsSide) {
    const MachineTree router =
        read(edited("type: angular", "type: linear")
                 .replace(edited("type: angular", "type: linear").find("axis: c"), 7, "axis: z"));
    ASSERT_TRUE(router.faults.empty());
    EXPECT_FALSE(router.roles[1].is_table_side || router.roles[2].is_table_side);
    const MachineTree knee = read(edited("axis: x", "axis: -z"));
    ASSERT_TRUE(knee.faults.empty());
    EXPECT_TRUE(knee.roles[1].is_table_side && knee.roles[2].is_table_side);
}

// QtPyVCP takes every map as a part, at the top as well.
TEST(MachineTree, EachMapIsAPartWhateverItsKey) {
    std::string text = kTree;
    for (const char* const key : {"root:", "child_x:", "child_plate:", "child_head:"}) {
        const std::string other = std::string(key) == "root:" ? "machine:" : "p" + std::string(key);
        text.replace(text.find(key), std::string(key).size(), other);
    }
    const MachineTree renamed = read(text);
    ASSERT_TRUE(renamed.faults.empty()) << to_string(renamed.faults[0]);
    EXPECT_EQ(renamed.roles.size(), 4U);
    const MachineTree two = read(edited(
        "  child_head:\n    id: head\n    model: head.stl\n    type: linear\n    position: [0, "
        "0, 0, 0, 0, 0]\n    axis: z\n",
        "head:\n  id: head\n  model: head.stl\n  type: linear\n  position: [0, 0, 0, 0, 0, "
        "0]\n  axis: z\n"));
    ASSERT_TRUE(two.faults.empty()) << to_string(two.faults[0]);
    ASSERT_EQ(two.roles.size(), 4U);
    EXPECT_EQ(two.roles[3].parent, kNoParent);
}

TEST(MachineTree, AFaultNamesItsLineAndKey) {
    const std::string head =
        "  child_head:\n    id: head\n    model: head.stl\n    type: linear\n    position: [0, 0, "
        "0, 0, 0, 0]\n    axis: z\n";
    const struct {
        std::string from, to, wanted;
    } edits[] = {
        {"axis: x", "axis: q", "machine.yml:13: root.child_x.axis: "},
        {"axis: x", "axis: xy", "machine.yml:13: root.child_x.axis: "},
        {"axis: x", "axis: \"--x\"", "machine.yml:13: root.child_x.axis: "},
        {"axis: x", "axis: [x]", "machine.yml:13: root.child_x.axis: "},
        {"axis: x", "axis: b", "machine.yml:11: root.child_x.type: "},
        {"type: angular", "type: head", "machine.yml:17: root.child_x.child_plate.type: "},
        {"axis: x", "Axis: x", "machine.yml:13: root.child_x.Axis: unknown key. Did you mean"},
        {"model: head.stl", "model: none.stl", "machine.yml:23: root.child_head.model: "},
        {"model: head.stl", "model: x.stl", "root.child_head.model: "},
        {"model: head.stl", "color: red", "root.child_head.model: missing required key"},
        {"[1, 2, 3, 0, 0, 0]", "[1, 2, 3, 0, 0, 90]", "machine.yml:12: root.child_x.position: "},
        {"[1, 2, 3, 0, 0, 0]", "[1, 2, 3]", "machine.yml:12: root.child_x.position: "},
        {"    position: [1, 2, 3, 0, 0, 0]\n", "", "root.child_x.position: missing required key"},
        {"origin: [0, 1, -18]", "origin: [0, 0, .nan]", "root.child_x.child_plate.origin"},
        {head, "  heads:\n    - id: head\n      model: head.stl\n", "machine.yml:21: root.heads: "},
        {kTree, kTree.substr(0, kTree.find("  child_x:")),
         "machine.yml:1: root: invalid value "
         "(found 1 part"},
        {kTree, "root: 3\n", "machine.yml:1: root: invalid value (found 0 part"},
    };
    for (const auto& edit : edits) {
        const MachineTree tree = read(edited(edit.from, edit.to));
        ASSERT_FALSE(tree.faults.empty()) << edit.to;
        EXPECT_TRUE(has(to_string(tree.faults[0]), edit.wanted)) << to_string(tree.faults[0]);
    }
    std::string resting = kTree;
    for (const char* const axis : {"axis: x", "axis: c", "axis: z"}) {
        resting.replace(resting.find(axis), 7, "axis: ~");
    }
    ASSERT_EQ(read(resting).faults.size(), 1U);
    EXPECT_TRUE(has(to_string(read(resting).faults[0]), "found no part that moves"));
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
        EXPECT_EQ(role.axis.empty(), joint.axis == kNoIndex) << role.name;
        EXPECT_EQ(role.at_mm, (Vec3d{body->at.t[0], body->at.t[1], body->at.t[2]})) << role.name;
        if (joint.axis != kNoIndex) {
            EXPECT_EQ(role.axis, machine.axes[joint.axis].name);
            const Vec3d way = joint.direction;
            EXPECT_EQ(role.is_table_side, way.x + way.y + way.z < 0) << role.name;
            // The file has no minus, and the table moves against its command: a doubt says so.
            EXPECT_EQ(role.way_doubt.empty(), !role.is_table_side) << role.name;
            EXPECT_EQ(role.pivot_doubt, "") << role.name;
        }
        if (role.axis == "A" || role.axis == "C") {
            EXPECT_EQ(role.pivot_mm, joint.pivot_mm) << role.name;
        }
    }
}

}  // namespace
}  // namespace axg
