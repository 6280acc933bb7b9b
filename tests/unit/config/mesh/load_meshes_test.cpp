// SPDX-License-Identifier: Apache-2.0
// Files that a machine names: what may be opened, what is refused and why, all at once; the
// allowances by name.
#include "config/mesh/load_meshes.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "config/text/open_beneath.hpp"
#include "core/mesh/mesh_check.hpp"
#include "core/mesh/stl.hpp"
#include "tests/support/solids.hpp"

namespace {

using namespace axg;
using axg::test::box;
using axg::test::moved;
using axg::test::together;
using axg::test::Triangles;
using axg::test::turned_over;
namespace fs = std::filesystem;

class LoadMeshes : public testing::Test {
  protected:
    void SetUp() override {
        char name[] = "/tmp/axg_meshes_XXXXXX";
        ASSERT_NE(::mkdtemp(name), nullptr);
        outside_ = name;
        root_ = outside_ + "/root";
        fs::create_directories(root_ + "/sub");
        write(outside_ + "/secret.stl", box({0, 0, 0}, {1, 1, 1}));
        write(root_ + "/box.stl", box({0, 0, 0}, {10, 20, 30}));
        write(root_ + "/sub/box.stl", box({0, 0, 0}, {1, 2, 3}));
    }
    void TearDown() override { fs::remove_all(outside_); }

    static void write(const std::string& path, const Triangles& triangles) {
        const std::vector<std::byte> bytes = write_stl(triangles);
        std::ofstream(path, std::ios::binary)
            .write(reinterpret_cast<const char*>(bytes.data()),
                   static_cast<std::streamsize>(bytes.size()));
    }
    static MeshSource source(const std::string& file) {
        MeshSource s;
        s.file = file;
        s.where = "machine.yaml:7";
        return s;
    }
    static Machine machine_with(const std::vector<MeshSource>& sources) {
        Machine machine;
        for (std::size_t i = 0; i < sources.size(); ++i) {
            Body body;
            body.name = "body" + std::to_string(i);
            body.has_mesh = true;
            body.mesh = sources[i];
            machine.bodies.push_back(body);
        }
        return machine;
    }
    std::vector<ConfigFault> load(const MeshSource& s) {
        return load_meshes(machine_with({s}), root_, out_);
    }
    /// One fault whose `got` and `wanted` contain these words.
    void expect_fault(const MeshSource& s, const std::string& got, const std::string& wanted) {
        const auto faults = load(s);
        ASSERT_EQ(faults.size(), 1U) << s.file << ": " << (faults.empty() ? "" : faults[0].got);
        EXPECT_EQ(faults[0].where, "machine.yaml:7");
        EXPECT_EQ(faults[0].key.rfind("bodies.body0.mesh", 0), 0U) << faults[0].key;
        EXPECT_NE(faults[0].got.find(got), std::string::npos) << faults[0].got;
        EXPECT_NE(faults[0].wanted.find(wanted), std::string::npos) << faults[0].wanted;
    }
    void expect_fault_of(const Triangles& triangles, const std::string& got) {
        write(root_ + "/bad.stl", triangles);
        expect_fault(source("bad.stl"), got, "");
    }

    std::string outside_, root_;
    MachineMeshes out_;
};

TEST_F(LoadMeshes, ReadsFilesBeneathTheRoot) {
    ASSERT_TRUE(load(source("box.stl")).empty());
    EXPECT_EQ(out_.bodies.at(0).triangles, box({0, 0, 0}, {10, 20, 30}));
    EXPECT_EQ(out_.bodies[0].name, "body0");
    EXPECT_TRUE(load(source("sub/box.stl")).empty());
    EXPECT_TRUE(load(source("./sub/box.stl")).empty());
}

TEST_F(LoadMeshes, NothingOutsideTheRootIsOpened) {
    expect_fault(source("../secret.stl"), "leaves", "--mesh-root");
    expect_fault(source("sub/../../secret.stl"), "leaves", "a file below it");
    expect_fault(source(outside_ + "/secret.stl"), "absolute", "relative");
    expect_fault(source(""), "no file name", "relative");
    ASSERT_EQ(::symlink("../secret.stl", (root_ + "/link.stl").c_str()), 0);
    expect_fault(source("link.stl"), "link", "");
    ASSERT_EQ(::symlink((outside_ + "/secret.stl").c_str(), (root_ + "/far.stl").c_str()), 0);
    expect_fault(source("far.stl"), "link", "");
    ASSERT_EQ(::symlink("..", (root_ + "/up").c_str()), 0);
    expect_fault(source("up/secret.stl"), "", "");
    expect_fault(source("none.stl"), "No such file", "readable");
    EXPECT_EQ(load_meshes(machine_with({source("box.stl")}), root_ + "/none", out_).size(), 1U);
}

TEST_F(LoadMeshes, TheWalkOfOldKernelsIsNoMoreTrusting) {
    const auto got = [&](const std::string& file) {
        return read_beneath(root_, file, 1000, PathLookup::walk).got;
    };
    EXPECT_EQ(got("box.stl"), "");
    EXPECT_EQ(got("./sub//box.stl"), "");
    EXPECT_NE(got("sub/../box.stl").find("leaves"), std::string::npos);
    EXPECT_NE(got("../secret.stl").find("leaves"), std::string::npos);
    EXPECT_NE(got("sub/.."), "");
    ASSERT_EQ(::symlink("../secret.stl", (root_ + "/link.stl").c_str()), 0);
    EXPECT_NE(got("link.stl").find("symbolic link"), std::string::npos);
    ASSERT_EQ(::symlink("..", (root_ + "/up").c_str()), 0);
    EXPECT_NE(got("up/secret.stl"), "");
    ASSERT_EQ(::mkfifo((root_ + "/fifo.stl").c_str(), 0600), 0);
    EXPECT_NE(got("fifo.stl").find("FIFO"), std::string::npos);
    EXPECT_NE(got("none/box.stl"), "");
    EXPECT_EQ(read_beneath(root_, "box.stl", 684, PathLookup::walk).bytes.size(), 684U);
    EXPECT_NE(read_beneath(root_, "box.stl", 683, PathLookup::walk).got, "");
}

TEST_F(LoadMeshes, WhatIsNoRegularFileIsRefusedWithoutWaiting) {
    ASSERT_EQ(::mkfifo((root_ + "/fifo.stl").c_str(), 0600), 0);
    expect_fault(source("fifo.stl"), "FIFO", "regular");
    expect_fault(source("sub"), "folder", "regular");
    const auto faults = load_meshes(machine_with({source("null")}), "/dev", out_);
    ASSERT_EQ(faults.size(), 1U);
    EXPECT_NE(faults[0].got.find("device"), std::string::npos) << faults[0].got;
}

TEST_F(LoadMeshes, AFileTooLargeIsRefusedBeforeItIsRead) {
    std::ofstream(root_ + "/huge.stl") << "solid";
    fs::resize_file(root_ + "/huge.stl", 5ULL << 40U);  // sparse
    const auto start = std::chrono::steady_clock::now();
    expect_fault(source("huge.stl"), "5497558138880 bytes", "at most");
    EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(1));
}

TEST_F(LoadMeshes, TheUnitIsAppliedAndTheStatedSizeTellsAWrongOne) {
    MeshSource s = source("box.stl");
    s.unit = LengthUnit::inch;
    s.expected_size_mm = {254, 508, 762};
    ASSERT_TRUE(load(s).empty());
    EXPECT_EQ(out_.bodies.at(0).triangles[1].b.z, 0.0F);
    s.unit = LengthUnit::mm;
    expect_fault(s, "[10, 20, 30]", "[254, 508, 762]");
    s.expected_size_mm = {10.09, 19.81, 30};
    EXPECT_TRUE(load(s).empty());
    s.expected_size_mm = {10.12, 20, 30};
    expect_fault(s, "[10, 20, 30]", "unit");
    s.expected_size_mm = {};
    s.unit = LengthUnit::m;
    EXPECT_TRUE(load(s).empty());
    EXPECT_EQ(out_.bodies.at(0).triangles, box({0, 0, 0}, {10000, 20000, 30000}));
}

TEST_F(LoadMeshes, APinnedFileMayNotChange) {
    // Known answer: FIPS 180-2, "abc".
    std::ofstream(root_ + "/abc.stl") << "abc";
    MeshSource s = source("abc.stl");
    s.sha256 = "BA7816BF8F01CFEA414140DE5DAE2223B00361A396177A9CB410FF61F20015AD";
    expect_fault(s, "neither", "");  // the hash is right: on to the contents
    s.sha256[0] = 'c';
    expect_fault(s, "ba7816bf", "restore the file, or state the hash of the new one");
}

TEST_F(LoadMeshes, AnUnsoundBodyIsRefusedByName) {
    Triangles open = box({0, 0, 0}, {1, 1, 1});
    open.pop_back();
    expect_fault_of(open, "3 open edges");
    expect_fault_of(turned_over(box({0, 0, 0}, {1, 1, 1})), "inside out");
    const Triangles cube = box({0, 0, 0}, {1, 1, 1});
    expect_fault_of(together(cube, moved(cube, {0.5F, 0.25F, 0.125F})), "cross");
    expect_fault_of(together(cube, box({0.2F, 0.2F, 0.2F}, {0.5F, 0.5F, 0.5F})), "inside another");
    Triangles flat = cube;
    flat.push_back({{0, 0, 0}, {0, 0, 0}, {1, 0, 0}});
    expect_fault_of(flat, "without area");
    // All facets without area: no surface is left, whatever is allowed.
    write(root_ + "/needle.stl", {{{0, 0, 0}, {0, 0, 0}, {1, 0, 0}}});
    MeshSource s = source("needle.stl");
    s.allow_degenerate = s.allow_open = s.allow_self_intersection = true;
    expect_fault(s, "not one facet", "");
}

TEST_F(LoadMeshes, WhatIsAllowedByNameIsLoadedAndNoted) {
    Triangles open = box({0, 0, 0}, {1, 1, 1});
    open.pop_back();
    write(root_ + "/open.stl", open);
    MeshSource s = source("open.stl");
    s.allow_self_intersection = s.allow_degenerate = true;  // the wrong names
    EXPECT_EQ(load(s).size(), 1U);
    s.allow_open = true;
    ASSERT_TRUE(load(s).empty());
    ASSERT_EQ(out_.notes.size(), 1U);
    EXPECT_NE(out_.notes[0].find("bodies.body0.mesh"), std::string::npos);

    Triangles flat = box({0, 0, 0}, {1, 1, 1});
    flat.push_back({{0, 0, 0}, {0, 0, 0}, {1, 0, 0}});
    write(root_ + "/flat.stl", flat);
    MeshSource f = source("flat.stl");
    f.allow_degenerate = true;
    ASSERT_TRUE(load(f).empty());
    EXPECT_EQ(out_.bodies.at(0).triangles.size(), 12U);
    EXPECT_NE(out_.notes.at(0).find(
                  "1 facet without area (first at facet 12), allowed: 1 removed, 0 kept"),
              std::string::npos)
        << out_.notes[0];

    // Three corners on a line close the gap beside an edge that was cut in two: the body stays
    // closed, so that what is inside it is seen.
    Triangles cut = box({0, 0, 0}, {1, 1, 1});
    const Triangle first = cut[0];
    const Vec3f middle = 0.5F * (first.a + first.b);
    cut[0] = {first.a, middle, first.c};
    cut.push_back({middle, first.b, first.c});
    cut.push_back({first.a, first.b, middle});
    write(root_ + "/flat.stl", cut);
    ASSERT_TRUE(load(f).empty());
    EXPECT_EQ(out_.bodies.at(0).triangles.size(), 14U);
    EXPECT_TRUE(check_mesh(out_.bodies.at(0).triangles).is_closed());

    const Triangles cube = box({0, 0, 0}, {1, 1, 1});
    write(root_ + "/two.stl", together(cube, moved(cube, {0.5F, 0.25F, 0.125F})));
    MeshSource t = source("two.stl");
    t.allow_self_intersection = true;
    EXPECT_TRUE(load(t).empty());
    EXPECT_EQ(out_.notes.size(), 1U);
}

TEST_F(LoadMeshes, AllFaultsOfAllFilesComeAtOnceAndNothingIsHandedOut) {
    Triangles open = box({0, 0, 0}, {1, 1, 1});
    open.pop_back();
    write(root_ + "/open.stl", open);
    out_.notes = {"untouched"};
    Machine machine = machine_with({source("box.stl"), source("open.stl"), source("none.stl")});
    Tool tool;
    tool.number = 4;
    Shape& shape = tool.mesh.shapes.emplace_back();
    shape.profile = {{0, 0, 0}, {0, 0, 1}};
    shape.key = "tools.4.profile_mm";
    shape.where = "machine.yaml:9";
    machine.tools.push_back(tool);
    const auto faults = load_meshes(machine, root_, out_);
    ASSERT_EQ(faults.size(), 3U);
    EXPECT_EQ(faults[2].key, "tools.4.profile_mm");
    EXPECT_EQ(faults[2].where, "machine.yaml:9");
    EXPECT_EQ(out_.notes.at(0), "untouched");
    EXPECT_TRUE(out_.bodies.empty());
}

MeshSource shapes(std::vector<Shape> list) {
    MeshSource s;
    s.shapes = std::move(list);
    for (Shape& shape : s.shapes) {
        shape.key = "bodies.body0.mesh.shapes";
        shape.where = "machine.yaml:7";
    }
    return s;
}

Shape box_at(Vec3d size, double x_mm) {
    Shape out;
    out.box_mm = size;
    out.at.t[0] = x_mm;
    return out;
}

Shape ball(double radius_mm, std::uint32_t segments) {
    Shape out;
    out.segments = segments;
    out.profile = sphere_profile(radius_mm, segments);
    return out;
}

// Across each other, inside each other, side by side: a vice is made so.
TEST_F(LoadMeshes, ShapesOfOneBodyMayLieAsTheyLike) {
    const Vec3d cube{10, 10, 10};
    ASSERT_TRUE(load(shapes({box_at(cube, 0), box_at(cube, 5), box_at(cube, 15), ball(2, 8),
                             box_at(cube, 0)}))
                    .empty());
    EXPECT_TRUE(out_.notes.empty());
    EXPECT_EQ(out_.bodies.at(0).triangles.size(), 4U * 12U + 8U * 2U * 3U);
    EXPECT_EQ(check_mesh(out_.bodies.at(0).triangles).open_shells, 0U);
}

TEST_F(LoadMeshes, AShapeThatFloat32CannotHoldIsRefused) {
    Shape far = ball(0.001, 48);
    far.at.t[1] = 9e4;  // where floats are 0.008 mm apart
    expect_fault(shapes({box_at({1, 1, 1}, 0), far}), "", "nearer to the origin");
    expect_fault(shapes({box_at({10, 10, 10}, 1e5)}), "beyond", "100000 mm");
    EXPECT_TRUE(load(shapes({box_at({10, 10, 10}, 1e5 - 5)})).empty());
}

TEST_F(LoadMeshes, ShapesTogetherHaveABoundedNumberOfTriangles) {
    const std::vector<Shape> many(5, ball(100, 512));  // 261,120 each
    expect_fault(shapes(many), "1305600 triangles", "at most 1048576");
}

TEST_F(LoadMeshes, ForeignTextIsPrintedWithoutItsControlCharacters) {
    expect_fault(source("a\x1b[31m\n.stl"), "a\\x1b[31m\\x0a.stl", "");
}

TEST_F(LoadMeshes, AToolBodyAndABareLinkHaveNoSurfaceOfTheirOwn) {
    Machine machine = machine_with({source("none.stl"), source("none.stl")});
    machine.bodies[0].is_tool = true;
    machine.bodies[1].has_mesh = false;
    Tool tool;
    Shape& shape = tool.mesh.shapes.emplace_back();
    shape.profile = {{0, 0, -5}, {2, 0, -5}, {2, 0, 0}, {0, 0, 0}};
    shape.segments = 8;
    machine.tools.push_back(tool);
    ASSERT_TRUE(load_meshes(machine, root_, out_).empty());
    EXPECT_TRUE(out_.bodies.at(0).triangles.empty());
    EXPECT_TRUE(out_.bodies.at(1).triangles.empty());
    EXPECT_EQ(out_.tools.at(0).triangles.size(), 32U);
}

// Drawn lying, 50 mm beside the axis: placed first, then turned.
TEST_F(LoadMeshes, AToolThatTurnsCountsWithWhatItSweeps) {
    write(root_ + "/blade.stl", box({0, 47, -4}, {60, 53, 4}));
    Machine machine;
    Tool& tool = machine.tools.emplace_back();
    tool.number = 3;
    tool.mesh = source("blade.stl");
    tool.mesh.at = {{{0, 0, 1}, {0, 1, 0}, {-1, 0, 0}}, {0, -50, 0}};  // x down, about Z
    ASSERT_TRUE(load_meshes(machine, root_, out_).empty());
    EXPECT_EQ(out_.tools.at(0).triangles, box({0, 47, -4}, {60, 53, 4}));
    EXPECT_TRUE(out_.notes.empty());

    tool.mesh.turns = true;
    ASSERT_TRUE(load_meshes(machine, root_, out_).empty());
    ASSERT_EQ(out_.notes.size(), 1U);
    EXPECT_NE(out_.notes[0].find("tools.3.mesh: turns with the spindle"), std::string::npos);
    const MeshReport report = check_mesh(out_.tools[0].triangles);
    EXPECT_TRUE(report.is_closed());
    EXPECT_NEAR(report.min_mm.z, -60, 1e-4);
    EXPECT_NEAR(report.max_mm.z, 0, 1e-4);
    EXPECT_NEAR(report.max_mm.x, 5, 0.031);
    EXPECT_GE(report.max_mm.x, 5);
    EXPECT_NEAR(report.volume_mm3, 25 * 3.14159 * 60, 60);

    tool.mesh.at.t[0] = 99900;
    ASSERT_TRUE(load_meshes(machine, root_, out_).empty());
    tool.mesh.at.t[0] = 99990;
    const auto faults = load_meshes(machine, root_, out_);
    ASSERT_EQ(faults.size(), 1U);
    EXPECT_NE(faults[0].got.find("a swept profile beyond the largest coordinate"),
              std::string::npos);
}

}  // namespace
