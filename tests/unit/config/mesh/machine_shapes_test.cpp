// SPDX-License-Identifier: Apache-2.0
// Surfaces put together from shapes, and tools from sections, of which some cut: what is read, what
// is made of it, and each way to get it wrong.
#include <gtest/gtest.h>

#include "config/machine/effective_text.hpp"
#include "config/mesh/cutting_parts.hpp"
#include "core/mesh/mesh_check.hpp"
#include "tests/support/machine_text.hpp"

namespace axg::test {
namespace {

/// The small machine with `base` made of these shapes.
std::string with_shapes(const std::string& shapes) {
    return with(kSmallMachine, "mesh: {file: base.stl, unit: mm}",
                "mesh: {shapes: [" + shapes + "]}");
}

/// The same with tool 1 made of these sections.
std::string with_sections(const std::string& sections) {
    return with(kSmallMachine, "mesh: {file: tool.stl, unit: mm}", "sections: [" + sections + "]");
}

Machine machine_of(const std::string& text) {
    Machine out;
    EXPECT_EQ(faults_of(text), "");
    EXPECT_TRUE(parse_machine(text, "m", out).empty());
    return out;
}

TEST(MachineShapes, EachKindIsRead) {
    const Machine machine = machine_of(with_shapes(
        "{box_mm: [200, 100, 30]}, {cylinder: {radius_mm: 20, height_mm: 50}, at_mm: [1, 2, 3]}, "
        "{cone: {radius_mm: 9, top_radius_mm: 4, height_mm: 7}, rotate_deg: [180, 0, 0]}, "
        "{cone: {radius_mm: 9, height_mm: 7}}, {sphere: {radius_mm: 6}, segments: 10}, "
        "{profile_mm: [[0, 0], [4, 1], [0, 2]]}"));
    const std::vector<Shape>& shapes = machine.bodies[0].mesh.shapes;
    ASSERT_EQ(shapes.size(), 6U);
    EXPECT_EQ(shapes[0].box_mm, (Vec3d{200, 100, 30}));
    EXPECT_TRUE(shapes[0].profile.empty());
    EXPECT_EQ(shapes[1].profile, cone_profile(20, 20, 50));
    EXPECT_EQ(shapes[1].at.t[2], 3);
    EXPECT_EQ(shapes[2].profile, cone_profile(9, 4, 7));
    EXPECT_EQ(shapes[2].at.r[2][2], -1);
    EXPECT_EQ(shapes[3].profile, cone_profile(9, 0, 7));
    EXPECT_EQ(shapes[4].profile, sphere_profile(6, 10));
    EXPECT_EQ(shapes[4].segments, 10U);
    EXPECT_EQ(shapes[5].profile.size(), 3U);
    EXPECT_EQ(shapes[5].segments, 48U);
    EXPECT_EQ(shapes[5].key, "bodies.base.mesh.shapes[5]");
    EXPECT_EQ(shapes[5].where, "m:11");
}

TEST(MachineShapes, SectionsOfAToolAreNamed) {
    const Machine machine = machine_of(
        with_sections("{name: flutes, cylinder: {radius_mm: 4, height_mm: 30}, "
                      "at_mm: [0, 0, -50]}, {name: holder, profile_mm: [[0, -20], [9, -20], "
                      "[0, 0]], segments: 12}"));
    const std::vector<Shape>& sections = machine.tools[0].mesh.shapes;
    ASSERT_EQ(sections.size(), 2U);
    EXPECT_EQ(sections[0].name, "flutes");
    EXPECT_EQ(sections[1].name, "holder");
    EXPECT_EQ(sections[1].key, "tools.1.sections[1]");
}

// The spindle's axis is that of the tool's body: all of a tool that turns is placed there.
TEST(MachineShapes, AToolTurnsUnlessTheFileSaysOtherwise) {
    const std::string sections = "{name: insert, box_mm: [4, 4, 6], at_mm: [20, 0, -60]}";
    const std::string lifted =
        with(with_sections(sections), "sections:", "at_mm: [1, 0, 5], sections:");
    const Tool turning = machine_of(lifted).tools[0];
    EXPECT_TRUE(turning.mesh.turns);
    EXPECT_EQ(turning.at.t[0], 0);
    EXPECT_EQ(turning.mesh.at.t[2], 5);
    EXPECT_TRUE(turning.mesh.shapes[0].turns);
    EXPECT_EQ(turning.mesh.shapes[0].at.t[0], 21);
    EXPECT_EQ(turning.mesh.shapes[0].at.t[2], -55);
    const Tool standing =
        machine_of(with(lifted, "at_mm: [1, 0, 5]", "turns: false, at_mm: [1, 0, 5]")).tools[0];
    EXPECT_FALSE(standing.mesh.turns);
    EXPECT_EQ(standing.at.t[0], 1);
    EXPECT_FALSE(standing.mesh.shapes[0].turns);
    EXPECT_EQ(standing.mesh.shapes[0].at.t[0], 20);
    EXPECT_NE(effective_text(machine_of(lifted)),
              effective_text(machine_of(with(lifted, "sections:", "turns: false, sections:"))));
}

/// One fault, with these words.
void expect_fault(const std::string& text, const std::string& words) {
    ASSERT_NE(text, "");
    const std::string faults = faults_of(text);
    EXPECT_EQ(std::count(faults.begin(), faults.end(), '\n'), 1) << faults;
    EXPECT_NE(faults.find(words), std::string::npos) << faults;
}

TEST(MachineShapes, EachBadSizeIsRefusedByName) {
    const std::string shape = "bodies.base.mesh.shapes[0]";
    for (const char* bad : {"-1", "0", "100001", ".nan", "1e99", "fat", "[1]"}) {
        const std::string size = bad;
        expect_fault(with_shapes("{box_mm: [1, " + size + ", 1]}"), shape + ".box_mm");
        expect_fault(with_shapes("{cylinder: {radius_mm: " + size + ", height_mm: 5}}"),
                     shape + ".cylinder.radius_mm");
        expect_fault(with_shapes("{cone: {radius_mm: 2, height_mm: " + size + "}}"),
                     shape + ".cone.height_mm");
        expect_fault(with_shapes("{sphere: {radius_mm: " + size + "}}"),
                     shape + ".sphere.radius_mm");
    }
    expect_fault(with_shapes("{cone: {radius_mm: 2, top_radius_mm: -1, height_mm: 1}}"),
                 shape + ".cone.top_radius_mm");
    expect_fault(with_shapes("{box_mm: [1, 1]}"), shape + ".box_mm");
    expect_fault(with_shapes("{box_mm: 5}"), shape + ".box_mm");
    expect_fault(with_shapes("{cylinder: 5}"), shape + ".cylinder");
    expect_fault(with_shapes("{cylinder: {radius_mm: 5}}"), shape + ".cylinder.height_mm");
    expect_fault(with_shapes("{cylinder: {radius_mm: 5, height_mm: 5, top_radius_mm: 2}}"),
                 shape + ".cylinder.top_radius_mm");
    expect_fault(with_shapes("{box_mm: [1, 1, 1], at_mm: [1e6, 0, 0]}"), shape + ".at_mm");
}

TEST(MachineShapes, TurnsIsASwitch) {
    expect_fault(with(with_sections("{name: a, box_mm: [1, 1, 1]}"),
                      "sections:", "turns: sometimes, sections:"),
                 "tools.1.turns");
}

TEST(MachineShapes, SegmentsHaveTheirRangeAndARoundBody) {
    for (const char* bad : {"7", "513", "1.5", "-8"}) {
        expect_fault(with_shapes("{sphere: {radius_mm: 5}, segments: " + std::string(bad) + "}"),
                     "shapes[0].segments");
    }
    expect_fault(with_shapes("{box_mm: [1, 1, 1], segments: 8}"), "no such key with box_mm");
    EXPECT_EQ(faults_of(with_shapes("{sphere: {radius_mm: 5}, segments: 8}")), "");
    EXPECT_EQ(faults_of(with_shapes("{sphere: {radius_mm: 5}, segments: 512}")), "");
}

TEST(MachineShapes, AShapeIsOneOfItsKinds) {
    expect_fault(
        with_shapes("{at_mm: [0, 0, 0]}"),
        "shapes[0]: invalid value (found no shape, expected one of box_mm, cylinder, cone, sphere");
    expect_fault(with_shapes("{box_mm: [1, 1, 1], sphere: {radius_mm: 1}}"),
                 "found box_mm and sphere, expected one of");
    expect_fault(with_shapes("5"), "shapes[0]");
    expect_fault(with_shapes("{name: jaw, box_mm: [1, 1, 1]}"), "name: unknown key");
}

TEST(MachineShapes, TheListHasOneToManyAndNoFileBesideIt) {
    expect_fault(with_shapes(""), "expected a list of 1 to 64 shapes");
    std::string many = "{sphere: {radius_mm: 1}}";
    for (int i = 1; i < 64; ++i) {
        many += ", {sphere: {radius_mm: 1}}";
    }
    EXPECT_EQ(faults_of(with_shapes(many)), "");
    expect_fault(with_shapes(many + ", {sphere: {radius_mm: 1}}"), "a list of 1 to 64 shapes");
    for (const char* key : {"file: a.stl", "unit: mm", "allow_open: true", "simplify_mm: 0.1"}) {
        const std::string text = with(with_shapes("{box_mm: [1, 1, 1]}"), "mesh: {shapes",
                                      "mesh: {" + std::string(key) + ", shapes");
        expect_fault(text, "together with shapes");
    }
}

TEST(MachineShapes, ASectionHasANameAndAToolOneSurface) {
    expect_fault(with_sections("{box_mm: [1, 1, 1]}"), "tools.1.sections[0].name");
    expect_fault(with_sections(""), "a list of 1 to 64 sections");
    expect_fault(
        with(with_sections("{name: a, box_mm: [1, 1, 1]}"), "sections:", "segments: 9, sections:"),
        "no such key with sections");
    expect_fault(with(with_sections("{name: a, box_mm: [1, 1, 1]}"),
                      "sections:", "profile_mm: [[0, 0], [1, 0], [0, 1]], sections:"),
                 "found profile_mm and sections");
}

TEST(MachineShapes, SectionsMayCutButNotAllOfThem) {
    const std::string two =
        "{name: a, cutting: true, box_mm: [1, 1, 1]}, {name: b, cutting: @, "
        "box_mm: [2, 2, 2]}";
    const Machine machine = machine_of(with_sections(with(two, "@", "false")));
    EXPECT_TRUE(machine.tools[0].mesh.shapes[0].is_cutting);
    EXPECT_FALSE(machine.tools[0].mesh.shapes[1].is_cutting);
    expect_fault(with_sections(with(two, "@", "true")), "found only cutting sections");
    expect_fault(with_sections(with(two, "@", "1")), "sections[1].cutting");
    expect_fault(with_shapes("{cutting: true, box_mm: [1, 1, 1]}"), "cutting: unknown key");
    const std::string other = with_sections(with(with(two, "true", "false"), "@", "true"));
    EXPECT_NE(effective_text(machine), effective_text(machine_of(other))) << "boards are told";
}

TEST(MachineShapes, StockIsABodyWithAMesh) {
    const std::string plate = "{name: plate, ", cutter = "{name: cutter, ";
    const Machine machine = machine_of(with(kSmallMachine, plate, plate + "stock: true, "));
    EXPECT_TRUE(machine.bodies[3].is_stock);
    EXPECT_FALSE(machine.bodies[2].is_stock);
    EXPECT_NE(effective_text(machine), effective_text(machine_of(kSmallMachine)));
    EXPECT_EQ(effective_text(machine_of(with(kSmallMachine, plate, plate + "stock: false, "))),
              effective_text(machine_of(kSmallMachine)));
    expect_fault(with(kSmallMachine, cutter, cutter + "stock: true, "), "the tool as stock");
    expect_fault(with(kSmallMachine, "  - {name: cutter,",
                      "  - {name: link, stock: true}\n  - {name: cutter,"),
                 "stock without a mesh");
}

/// The small machine with shapes alone, a cutting tool that stands and another one.
Machine cutting_machine() {
    const std::string text =
        with(with_sections("{name: flutes, cutting: true, box_mm: [4, 4, 10]}, "
                           "{name: shank, box_mm: [4, 4, 20], at_mm: [0, 0, 10]}"),
             "sections:", "turns: false, sections:");
    return machine_of(with(text, "{name: plate, ", "{name: plate, stock: true, "));
}

TEST(CuttingParts, APairWithStockHasTheRestOfTheTool) {
    Machine machine = cutting_machine();
    MachineMeshes meshes;
    part_cutters(machine, meshes);
    ASSERT_EQ(meshes.of_pairs.size(), 1U);
    const MeshReport rest = check_mesh(meshes.of_pairs[0].triangles);
    EXPECT_TRUE(rest.is_closed()) << "the face towards the flutes is one of the shank";
    EXPECT_EQ(rest.facet_count, 12U);
    EXPECT_EQ(rest.min_mm.z, 10);
    EXPECT_EQ(rest.max_mm.z, 30);
    ASSERT_EQ(machine.pair_surfaces.size(), 1U);
    const PairSurface& own = machine.pair_surfaces[0];
    EXPECT_EQ(own.body, 4U);
    EXPECT_EQ(own.against, 3U);
    EXPECT_EQ(own.tool, 0U) << "the other tool says of no part that it cuts";
    EXPECT_EQ(own.surface, 0U);
    EXPECT_TRUE(own.is_whole) << "what lies inside is asked of the rest alone";
}

TEST(CuttingParts, WithoutStockOrWithoutTheirPairThereIsNone) {
    MachineMeshes meshes;
    Machine no_stock = cutting_machine();
    no_stock.bodies[3].is_stock = false;
    Machine no_pair = cutting_machine();
    no_pair.pairs.pop_back();  // of the plate
    Machine no_cutter = cutting_machine();
    no_cutter.tools[0].mesh.shapes[0].is_cutting = false;
    for (Machine* machine : {&no_stock, &no_pair, &no_cutter}) {
        part_cutters(*machine, meshes);
        EXPECT_TRUE(meshes.of_pairs.empty());
        EXPECT_TRUE(machine->pair_surfaces.empty());
    }
}

TEST(MachineShapes, AProfileHasAsManyPointsAsCanBeTurned) {
    const auto profile = [](int points) {
        std::string text = "[0, 0]";
        for (int i = 2; i < points; ++i) {
            text += ", [1, " + std::to_string(i) + "]";
        }
        return "{profile_mm: [" + text + ", [0, 600]]}";
    };
    EXPECT_EQ(faults_of(with_shapes(profile(512))), "");
    expect_fault(with_shapes(profile(513)), "a list of 3 to 512 points");
}

}  // namespace
}  // namespace axg::test
