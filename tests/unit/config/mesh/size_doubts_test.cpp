// SPDX-License-Identifier: Apache-2.0
// A surface whose size contradicts the machine file is refused with its extents and the unit that
// fits: a wrong unit otherwise makes a body vanish. Both sides of each bound, and the way to
// insist.
#include "config/mesh/size_doubts.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "config/mesh/load_meshes.hpp"
#include "tests/support/solids.hpp"

namespace axg {
namespace {

/// Bodies that are cubes of these sides, as read from files in mm.
struct Cubes {
    Machine machine;
    MachineMeshes meshes;

    explicit Cubes(const std::vector<double>& sides_mm) {
        for (const double side : sides_mm) {
            Body body;
            body.name = "body" + std::to_string(machine.bodies.size());
            body.has_mesh = true;
            body.mesh.file = body.name + ".stl";
            body.mesh.where = "m.yaml:7";
            machine.bodies.push_back(body);
            const auto corner = static_cast<float>(side);
            meshes.bodies.push_back({body.name, test::box({0, 0, 0}, {corner, corner, corner})});
        }
    }
    /// A tool from 0 down to `tip_mm`, 10 mm thick.
    void add_tool(double length_mm, double tip_mm) {
        Tool tool;
        tool.number = 3;
        tool.length_mm = length_mm;
        tool.mesh.file = "cutter.stl";
        tool.mesh.where = "m.yaml:9";
        tool.mesh.turns = true;
        machine.tools.push_back(tool);
        meshes.tools.push_back({"", test::box({-5, -5, static_cast<float>(-tip_mm)}, {5, 5, 0})});
    }
    [[nodiscard]] std::string faults() const {
        std::string out;
        for (const ConfigFault& fault : doubt_sizes(machine, meshes)) {
            out += to_string(fault) + '\n';
        }
        return out;
    }
};

TEST(SizeDoubts, NameTheFileItsExtentsAndTheUnitThatFits) {
    EXPECT_EQ(
        Cubes({500, 400, 0.01}).faults(),
        "m.yaml:7: bodies.body2.mesh.unit: invalid value (found body2.stl: 0.01 x 0.01 x 0.01 mm "
        "in mm, 4e+04 times smaller than the median body (400 mm), expected unit: m, which makes "
        "it 10 x 10 x 10 mm). Or set size_is_right: true if the surface is that small.\n");
}

TEST(SizeDoubts, BeginAtAFiftiethOfTheMedianBody) {
    EXPECT_EQ(Cubes({100, 100, 2}).faults(), "");
    EXPECT_NE(Cubes({100, 100, 1.99}).faults(), "");
    EXPECT_NE(Cubes({100, 1.5}).faults(), "") << "of two bodies the larger one is believed";
}

TEST(SizeDoubts, BeginBelowOneMillimetreWhateverTheOthers) {
    EXPECT_EQ(Cubes({1, 1}).faults(), "");
    const std::string faults = Cubes({0.9, 1, 1}).faults();
    EXPECT_NE(faults.find("bodies.body0.mesh.unit"), std::string::npos) << faults;
    EXPECT_NE(Cubes({0.5}).faults(), "");
}

TEST(SizeDoubts, LeaveAloneWhatIsInsistedOnAndShapes) {
    Cubes insisted({500, 400, 0.01});
    insisted.machine.bodies[2].mesh.size_is_right = true;
    EXPECT_EQ(insisted.faults(), "");
    Cubes shapes({500, 400, 0.01});
    shapes.machine.bodies[2].mesh.file.clear();
    EXPECT_EQ(shapes.faults(), "");
}

TEST(SizeDoubts, HoldATipToTheLength) {
    for (const auto& [length_mm, tip_mm, fits] : {std::tuple{140.0, 140.0, true},
                                                  {140.0, 138.7, true},
                                                  {140.0, 138.5, false},
                                                  {140.0, 141.3, true},
                                                  {140.0, 141.5, false},
                                                  {20.0, 19.1, true},
                                                  {20.0, 18.9, false}}) {
        Cubes cubes({500});
        cubes.add_tool(length_mm, tip_mm);
        EXPECT_EQ(cubes.faults().empty(), fits) << cubes.faults();
        cubes.machine.tools[0].mesh.size_is_right = true;
        EXPECT_EQ(cubes.faults(), "");
    }
}

TEST(SizeDoubts, NameTheUnitOfATool) {
    Cubes cubes({500});
    cubes.add_tool(140, 140 / 25.4);
    const std::string faults = cubes.faults();
    EXPECT_NE(faults.find(
                  "tools.3.mesh.unit: invalid value (found cutter.stl: 10 x 10 x 5.51181 mm in mm"),
              std::string::npos)
        << faults;
    EXPECT_NE(faults.find("unit: inch, which makes it 254 x 254 x 140 mm"), std::string::npos)
        << faults;
}

TEST(SizeDoubts, PlaceAToolThatDoesNotTurn) {
    Cubes cubes({500});
    cubes.add_tool(140, 40);
    cubes.machine.tools[0].mesh.turns = false;
    EXPECT_NE(cubes.faults(), "");
    cubes.machine.tools[0].at.t[2] = -100;
    EXPECT_EQ(cubes.faults(), "");
}

TEST(SizeDoubts, HoldAProfileToTheLength) {
    Cubes cubes({500});
    cubes.add_tool(140, 14);
    cubes.machine.tools[0].mesh.file.clear();
    const std::string faults = cubes.faults();
    EXPECT_NE(
        faults.find("tools.3.length_mm: invalid value (found a tip 14 mm below the spindle nose"),
        std::string::npos)
        << faults;
}

}  // namespace
}  // namespace axg
