// SPDX-License-Identifier: Apache-2.0
// Drawings that load and cannot be meant, each just inside and just outside its bound, and the key
// that accepts them.
#include "config/mesh/drawing_doubts.hpp"

#include <gtest/gtest.h>

#include <string>
#include <tuple>
#include <vector>

#include "config/mesh/load_meshes.hpp"
#include "core/base/pose.hpp"
#include "core/mesh/shape.hpp"
#include "tests/support/solids.hpp"

namespace axg {
namespace {

/// A spindle of 200 mm above the nose, and a tool body on it.
struct Drawing {
    Machine machine;
    MachineMeshes meshes;

    Drawing() {
        add_body("spindle", test::box({-50, -50, 0}, {50, 50, 200}), kNoIndex);
        add_body("cutter", {}, 0);
        machine.bodies[1].is_tool = true;
    }
    void add_body(const std::string& name, test::Triangles triangles, std::uint32_t parent) {
        Body body;
        body.name = name;
        body.parent = parent;
        body.has_mesh = !triangles.empty();
        body.mesh.file = name + ".stl";
        body.mesh.where = "m.yaml:" + std::to_string(10 + machine.bodies.size());
        machine.bodies.push_back(body);
        meshes.bodies.push_back({name, std::move(triangles)});
    }
    /// Of round sections from low to high, as a profile each.
    void add_tool(const std::vector<std::tuple<std::string, double, double>>& sections) {
        Tool tool;
        tool.number = 7;
        tool.mesh.turns = true;
        tool.mesh.where = "m.yaml:40";
        test::Triangles all;
        for (const auto& [name, low, high] : sections) {
            Shape shape;
            shape.name = name;
            shape.profile = {{0, 0, low}, {5, 0, low}, {5, 0, high}, {0, 0, high}};
            shape.segments = 8;
            all = test::together(all, triangles_of(shape).triangles);
            tool.mesh.shapes.push_back(shape);
        }
        machine.tools.push_back(tool);
        meshes.tools.push_back({"", all});
    }
    [[nodiscard]] std::string doubts() const {
        std::string out;
        for (const std::string& line : doubt_drawings(machine, meshes)) {
            out += line + '\n';
        }
        return out;
    }
};

bool has(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
}

TEST(DrawingDoubts, AToolHangsBelowTheNose) {
    Drawing drawing;
    drawing.add_tool({{"mill", -90, -40}, {"holder", -40, 0}});
    EXPECT_EQ(drawing.doubts(), "");
    Drawing upwards;
    upwards.add_tool({{"mill", -90, -40}, {"holder", 0, 40}});
    EXPECT_EQ(upwards.doubts(),
              "m.yaml:40: tools.7: section holder reaches 40 mm above the spindle nose, into the "
              "spindle. A tool hangs below z = 0: correct at_mm or the heights, or set "
              "size_is_right: true.\n"
              "m.yaml:40: tools.7: nothing from -40 to 0 mm: the tool is in two parts. Correct "
              "at_mm or the heights, or set size_is_right: true.\n");
    upwards.machine.tools[0].mesh.size_is_right = true;
    EXPECT_EQ(upwards.doubts(), "");
}

TEST(DrawingDoubts, OneMillimetreIsAllowed) {
    const std::tuple<double, double, const char*> cases[] = {
        {-40, 1, ""},
        {-40, 1.1, "reaches 1.1 mm above"},
        {-39, 0, ""},
        {-38.9, 0, "nothing from -40 to -38.9 mm: the tool is in two parts"},
        {-40, -1, ""},
        {-40, -1.5, "nothing from -1.5 to 0 mm: the tool does not reach the spindle nose"}};
    for (const auto& [low, high, wanted] : cases) {
        Drawing drawing;
        drawing.add_tool({{"mill", -90, -40}, {"holder", low, high}});
        EXPECT_EQ(drawing.doubts().empty(), *wanted == '\0') << drawing.doubts();
        EXPECT_TRUE(has(drawing.doubts(), wanted)) << drawing.doubts();
    }
}

// A head that is drawn from its spindle's bearing up leaves room for a holder above the tool's
// zero.
TEST(DrawingDoubts, AHolderUpToASpindleThatEndsHigherIsRight) {
    for (const double top : {40.0, 41.0, 41.1}) {
        Drawing drawing;
        drawing.meshes.bodies[0].triangles = test::box({-50, -50, 40}, {50, 50, 200});
        drawing.add_tool({{"mill", -30, 20}, {"holder", 20, top}});
        EXPECT_EQ(has(drawing.doubts(), "into the spindle"), top > 41) << drawing.doubts();
    }
    Drawing aside;  // the box of the tool is beside the spindle's, as an angle head's
    aside.meshes.bodies[0].triangles = test::box({4.5F, -50, 0}, {104.5F, 50, 200});
    aside.add_tool({{"holder", -30, 40}});
    EXPECT_EQ(aside.doubts(), "");
    aside.meshes.bodies[0].triangles = test::box({3.5F, -50, 0}, {103.5F, 50, 200});
    EXPECT_TRUE(has(aside.doubts(), "into the spindle"));
}

// A profile has no section to name.
TEST(DrawingDoubts, AProfileWithHeightsAboveZero) {
    Drawing drawing;
    drawing.add_tool({{"", -90, 40}});
    EXPECT_TRUE(has(drawing.doubts(), "tools.7: the surface reaches 40 mm above the spindle nose"))
        << drawing.doubts();
}

// Its nose is drawn 60 mm lower than the frame of the tool body is.
TEST(DrawingDoubts, ASectionInsideTheSpindle) {
    Drawing drawing;
    drawing.meshes.bodies[0].triangles = test::box({-50, -50, -60}, {50, 50, 200});
    drawing.add_tool({{"mill", -90, -50}, {"holder", -50, 0}});
    EXPECT_EQ(drawing.doubts(),
              "m.yaml:40: tools.7: section holder is inside body spindle, which carries the tool. "
              "Correct its at_mm, or that of the tool body, or set size_is_right: true.\n");
    drawing.machine.bodies[1].at.t[2] = -60;
    EXPECT_EQ(drawing.doubts(), "");
}

std::vector<BodySize> sizes_of(const std::vector<double>& sides_mm) {
    std::vector<BodySize> sizes;
    for (const double side : sides_mm) {
        sizes.push_back({"part.stl", LengthUnit::mm, {side, side / 2, 1}});
    }
    return sizes;
}

TEST(UnitDoubts, NameTheUnitThatFits) {
    const auto doubts = doubt_units(sizes_of({400, 500, 12, 450}));
    EXPECT_EQ(
        doubts[2],
        "part.stl: 12 mm, 37.5 times smaller than the median body (450 mm); in inch 304.8 mm");
    EXPECT_TRUE(doubts[0].empty() && doubts[1].empty() && doubts[3].empty());
    std::vector<BodySize> large = sizes_of({400, 500, 10'160, 450});
    for (BodySize& one : large) {
        one.unit = LengthUnit::inch;
    }
    EXPECT_EQ(doubt_units(large)[2],
              "part.stl: 10160 mm, 20.3 times larger than the median body (500 mm); in mm 400 mm");
}

TEST(UnitDoubts, BeginAtAnEighthOfTheMedianBody) {
    EXPECT_EQ(doubt_units(sizes_of({400, 400, 50.1}))[2], "");
    EXPECT_NE(doubt_units(sizes_of({400, 400, 50}))[2], "");
    EXPECT_EQ(doubt_units(sizes_of({400, 400, 3190}))[2], "");
    EXPECT_EQ(doubt_units(sizes_of({400, 400, 12'000}))[2], "") << "larger in inch";
}

TEST(UnitDoubts, LeaveAloneAPartAsSmallAsItsCarrier) {
    std::vector<BodySize> sizes = sizes_of({400, 500, 12, 450, 20});
    sizes[2].parent = 4;
    EXPECT_EQ(doubt_units(sizes)[2], "") << "of 20 mm, it fits better as it is";
    sizes[2].parent = 0;
    EXPECT_NE(doubt_units(sizes)[2], "");
    sizes[2].is_doubtful = false;
    EXPECT_EQ(doubt_units(sizes)[2], "");
}

TEST(DrawingDoubts, ABodyInInchIsNamedWithItsPlace) {
    Drawing drawing;
    drawing.add_body("plate", test::box({-4, -4, 100}, {4, 4, 104}), 0);
    EXPECT_EQ(
        drawing.doubts(),
        "m.yaml:12: bodies.plate.mesh: plate.stl: 8 mm, 25 times smaller than the median body "
        "(200 mm); in inch 203.2 mm. Correct unit, or set size_is_right: true.\n");
    drawing.machine.bodies[2].mesh.size_is_right = true;
    EXPECT_EQ(drawing.doubts(), "");
}

TEST(DrawingDoubts, ABodyThatNothingTouches) {
    for (const auto& [low, wanted] :
         {std::pair{60.0F, ""}, {62.0F, "12 mm or more from spindle"}}) {
        Drawing drawing;
        drawing.add_body("lamp", test::box({low, 0, 0}, {low + 100, 10, 10}), 0);
        EXPECT_EQ(drawing.doubts().empty(), *wanted == '\0') << drawing.doubts();
        EXPECT_TRUE(has(drawing.doubts(), wanted)) << drawing.doubts();
        drawing.machine.bodies[2].parent = kNoIndex;  // of a frame that is not drawn
        EXPECT_EQ(drawing.doubts(), "");
    }
}

}  // namespace
}  // namespace axg
