// SPDX-License-Identifier: Apache-2.0
// ctest-labels: data
// The real meshes against the figures measured independently of this code (the README beside them).
// Where the definitions differ it is said here: there, self-intersecting pairs are those without a
// common vertex; here, check_mesh also counts neighbours that cross or cover each other, so its
// count may only be larger.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>

#include "config/compiled/compiled_machine.hpp"
#include "config/mesh/load_meshes.hpp"
#include "config/mesh/size_doubts.hpp"
#include "core/mesh/mesh_check.hpp"
#include "core/mesh/stl.hpp"

namespace {

using namespace axg;

const std::string kData = AXG_SHARED_DATA;

struct Row {
    const char* file;
    bool is_binary;
    std::uint32_t triangles, non_manifold, degenerate, self_pairs, parts, inverted;
};

// All are closed: no open edge. Degenerate: area exactly zero.
constexpr Row kRows[] = {
    {"machines/probe-basic-xyzac/frame.stl", true, 84, 0, 0, 0, 1, 0},
    {"machines/probe-basic-xyzac/saddle.stl", true, 132, 0, 0, 0, 1, 0},
    {"machines/probe-basic-xyzac/table.stl", true, 1552, 0, 0, 0, 1, 0},
    {"machines/probe-basic-xyzac/a_axis.stl", true, 10076, 0, 0, 0, 1, 0},
    {"machines/probe-basic-xyzac/c_axis.stl", true, 2134, 0, 0, 0, 1, 0},
    {"machines/probe-basic-xyzac/headstock.stl", true, 2016, 0, 0, 0, 1, 0},
    {"tools/thread_mill.stl", true, 1296, 0, 0, 0, 1, 0},
    {"tools/spindle_elte.stl", true, 15396, 126, 0, 807, 13, 0},
    {"workpieces/work_piece_1.stl", false, 90, 0, 0, 0, 1, 0},
    {"workpieces/beet_mm.stl", false, 4630, 0, 1, 1, 1, 1},
};

class SharedMesh : public testing::TestWithParam<Row> {};

TEST_P(SharedMesh, IsJudgedAsItWasMeasured) {
    const Row& row = GetParam();
    const std::string path = kData + "/" + row.file;
    if (!std::filesystem::exists(path)) {
        GTEST_SKIP() << "no " << path << ": set AXG_SHARED_DATA";
    }
    std::ifstream in(path, std::ios::binary);
    const std::vector<char> bytes{std::istreambuf_iterator<char>(in), {}};
    const StlResult stl = read_stl(std::as_bytes(std::span(bytes)), 1.0);
    ASSERT_TRUE(stl.faults.empty());
    EXPECT_EQ(stl.is_binary, row.is_binary);
    const MeshReport report = check_mesh(stl.triangles);
    EXPECT_EQ(report.facet_count, row.triangles);
    EXPECT_EQ(report.open_edges, 0U);
    EXPECT_EQ(report.flipped_edges, 0U);
    EXPECT_EQ(report.non_manifold_edges, row.non_manifold);
    EXPECT_EQ(report.degenerate_facets, row.degenerate);
    EXPECT_EQ(report.shells, row.parts);
    EXPECT_EQ(report.inverted_shells, row.inverted);
    EXPECT_TRUE(report.self_complete);
    EXPECT_GE(report.self_intersections, row.self_pairs);
    EXPECT_EQ(report.self_intersections == 0, row.self_pairs == 0);
}

std::string name_of(const testing::TestParamInfo<Row>& info) {
    return std::filesystem::path(info.param.file).stem().string();
}

INSTANTIATE_TEST_SUITE_P(All, SharedMesh, testing::ValuesIn(kRows), name_of);

TEST(SharedMachine, ProbeBasicLoadsWholeWithoutANote) {
    const std::string folder = kData + "/machines/probe-basic-xyzac";
    if (!std::filesystem::exists(folder)) {
        GTEST_SKIP() << "no " << folder << ": set AXG_SHARED_DATA";
    }
    Machine machine;
    auto faults = load_machine(
        std::string(AXG_SOURCE_DIR) + "/config/machines/probe-basic-xyzac.yaml", machine);
    ASSERT_TRUE(faults.empty()) << to_string(faults[0]);
    MachineMeshes meshes;
    faults = load_meshes(machine, folder, meshes);
    ASSERT_TRUE(faults.empty()) << to_string(faults[0]);
    faults = doubt_sizes(machine, meshes);
    ASSERT_TRUE(faults.empty()) << to_string(faults[0]);
    EXPECT_TRUE(meshes.notes.empty());
    std::size_t triangles = 0;
    for (const Mesh& mesh : meshes.bodies) {
        triangles += mesh.triangles.size();
    }
    EXPECT_EQ(triangles, 84U + 132U + 1552U + 10076U + 2134U + 2016U);
}

}  // namespace
