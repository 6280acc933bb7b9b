// SPDX-License-Identifier: Apache-2.0
// ctest-labels: data
// The engine and the certified test on cases made elsewhere, whose answers come from exact
// integers: no intersecting case is called apart, no clearance is above the distance, what must be
// refused is. Format: README of the folder tritri.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <fstream>
#include <optional>
#include <string>
#include <vector>

#include "core/collision/closest_direction.hpp"
#include "core/collision/cpu_engine.hpp"
#include "tests/support/tritri_files.hpp"

namespace axg::test {
namespace {

struct Report {
    unsigned intersecting = 0, apart = 0, refused = 0, outside = 0;
    double undecided_mm = 0;  // widest distance not told apart
    double short_mm = 0;      // clearance too small by at most
    double short_share = 0;   // the same as a share of the pair's extent

    void too_short(double by_mm, double extent_mm) {
        short_mm = std::max(short_mm, by_mm);
        short_share = std::max(short_share, by_mm / std::max(extent_mm, 1e-3));
    }

    void print(const char* name) const {
        std::printf(
            "%s: %u intersecting, %u apart, %u refused as they must be, %u beyond the "
            "domain; widest undecided %.3g um; clearance too small by at most %.3g um, "
            "%.3g of the extent\n",
            name, intersecting, apart, refused, outside, 1e3 * undecided_mm, 1e3 * short_mm,
            short_share);
    }
};

QueryResult run_query(CpuEngine& engine, Query query, QueryKind what) {
    query.kind = what;
    query.r_mm = what == QueryKind::clearance ? kMarginMmMax : 0;
    QueryResult result;
    engine.run({&query, 1}, {&result, 1});
    return result;
}

void judge(CpuEngine& engine, const Query& query, const TritriExpected& expected, bool is_outside,
           double extent_mm, Report& report, std::uint32_t id) {
    const QueryResult farther = run_query(engine, query, QueryKind::farther);
    const QueryResult clearance = run_query(engine, query, QueryKind::clearance);
    if (expected.answer == 'R' || is_outside) {
        EXPECT_EQ(farther.status, QueryStatus::bad_query) << id;
        EXPECT_EQ(clearance.status, QueryStatus::bad_query) << id;
        ++(expected.answer == 'R' ? report.refused : report.outside);
        return;
    }
    EXPECT_EQ(farther.status, QueryStatus::ok) << id;
    EXPECT_EQ(clearance.status, QueryStatus::ok) << id;
    if (expected.answer == '1') {
        ++report.intersecting;
        EXPECT_EQ(farther.proof, Proof::not_proven) << id << ": a missed contact";
        EXPECT_EQ(clearance.proof, Proof::not_proven) << id << ": a missed contact";
        EXPECT_EQ(clearance.clearance_mm, 0) << id;
        EXPECT_GT(run_query(engine, query, QueryKind::touching).touching, 0U) << id;
        return;
    }
    ASSERT_EQ(expected.answer, '0') << id;
    ++report.apart;
    const double above = std::nextafter(expected.distance_mm, HUGE_VAL);  // the text was rounded
    EXPECT_LE(clearance.clearance_mm, above) << id;
    if (farther.proof != Proof::far) {
        report.undecided_mm = std::max(report.undecided_mm, expected.distance_mm);
    }
    report.too_short(std::min(expected.distance_mm, kMarginMmMax) - clearance.clearance_mm,
                     extent_mm);
}

CpuEngine engine_of(const std::vector<Mesh>& meshes) {
    std::vector<const Mesh*> pointers;
    for (const Mesh& mesh : meshes) {
        pointers.push_back(&mesh);
    }
    return std::move(*CpuEngine::create(pointers, Capacities{}));
}

constexpr double kMeshExtentMm = 100;  // of the meshes of the set
// A distance of 1e-8 of the extent has a direction good to 1e-8: docs/theory/accuracy.md,
// "Clearance".
constexpr double kShortShare = 0x1p-24;

/// Longest edge, mm.
double extent_of(const Triangle& t) {
    double most = 0;
    for (const Vec3f& e : {t.b - t.a, t.c - t.b, t.a - t.c}) {
        most = std::max(most, std::sqrt(dot(widen(e), widen(e))));
    }
    return most;
}

bool beyond(const Triangle& t) {
    float most = 0;
    for (const Vec3f& v : {t.a, t.b, t.c}) {
        most = std::max({most, std::fabs(v.x), std::fabs(v.y), std::fabs(v.z)});
    }
    return most > kCoordinateMmMax;
}

class Tritri : public testing::Test {
  protected:
    void SetUp() override {
        if (!std::ifstream(kTritriFolder + "answers.csv")) {
            GTEST_SKIP() << "no " << kTritriFolder
                         << "answers.csv: set the CMake variable AXG_SHARED_DATA";
        }
    }

    /// One file of pairs of float triangles through the engine: B placed in A's frame.
    static Report judge_pairs(const std::string& name) {
        const TritriAnswers answers = read_tritri_answers(kTritriFolder + "answers.csv");
        Bytes bytes(kTritriFolder + name);
        Report report;
        EXPECT_EQ((bytes.take<std::array<char, 4>>()), (std::array{'T', 'T', 'P', '1'}));
        EXPECT_EQ(bytes.take<std::uint32_t>(), 4U);
        const bool posed = bytes.take<std::uint32_t>() != 0;
        const auto count = bytes.take<std::uint32_t>();
        for (std::uint32_t i = 0; i < count && !HasFailure(); ++i) {
            const auto id = bytes.take<std::uint32_t>();
            const Triangle a = take_triangle(bytes), b = take_triangle(bytes);
            Query query{.mesh_a = 1, .mesh_b = 0, .pose = {}};
            if (posed) {
                query.pose = take_pose(bytes);
            }
            bool is_outside = beyond(a) || beyond(b);
            for (const double t : query.pose.t) {
                is_outside = is_outside || std::fabs(t) > 4 * kCoordinateMmMax;
            }
            CpuEngine engine = engine_of({{"a", {a}}, {"b", {b}}});
            judge(engine, query, answers.at(id), is_outside, std::max(extent_of(a), extent_of(b)),
                  report, id);
        }
        EXPECT_TRUE(bytes.at_end());
        report.print(name.c_str());
        return report;
    }
};

TEST_F(Tritri, PairsOfFloatTriangles) {
    const Report report = judge_pairs("pairs_f32.bin");
    EXPECT_GT(report.intersecting, 1000U);
    EXPECT_LE(report.undecided_mm, 1e-6);
    EXPECT_LE(report.short_share, kShortShare);
}

TEST_F(Tritri, PosedPairs) {
    const Report report = judge_pairs("pairs_pose.bin");
    EXPECT_GT(report.intersecting, 100U);
    EXPECT_LE(report.undecided_mm, 1e-6);
    EXPECT_LE(report.short_share, kShortShare);
}

TEST_F(Tritri, Meshes) {
    const TritriAnswers answers = read_tritri_answers(kTritriFolder + "mesh_answers.csv");
    Bytes bytes(kTritriFolder + "meshes.bin");
    ASSERT_EQ((bytes.take<std::array<char, 4>>()), (std::array{'T', 'T', 'M', '1'}));
    std::vector<Mesh> meshes(bytes.take<std::uint32_t>());
    for (Mesh& mesh : meshes) {
        const auto triangles = bytes.take<std::uint32_t>();
        mesh.name = bytes.take<std::array<char, 32>>().data();
        for (std::uint32_t i = 0; i < triangles; ++i) {
            mesh.triangles.push_back(take_triangle(bytes));
        }
    }
    CpuEngine engine = engine_of(meshes);
    Report report;
    const auto count = bytes.take<std::uint32_t>();
    for (std::uint32_t i = 0; i < count; ++i) {
        const auto id = bytes.take<std::uint32_t>();
        Query query{.mesh_a = 0, .mesh_b = bytes.take<std::uint32_t>(), .pose = {}};
        query.mesh_a = bytes.take<std::uint32_t>();
        query.pose = take_pose(bytes);
        judge(engine, query, answers.at(id), false, kMeshExtentMm, report, id);
    }
    EXPECT_TRUE(bytes.at_end());
    report.print("meshes.bin");
    EXPECT_GT(report.apart, 100U);
    EXPECT_LE(report.undecided_mm, 1e-6);
    EXPECT_LE(report.short_share, kShortShare);
}

// The double test alone, on vertices that are doubles: what the recheck rests on.
TEST_F(Tritri, PairsOfDoubleTriangles) {
    const TritriAnswers answers = read_tritri_answers(kTritriFolder + "answers.csv");
    Bytes bytes(kTritriFolder + "pairs_f64.bin");
    ASSERT_EQ((bytes.take<std::array<char, 4>>()), (std::array{'T', 'T', 'P', '1'}));
    ASSERT_EQ(bytes.take<std::uint32_t>(), 8U);
    ASSERT_EQ(bytes.take<std::uint32_t>(), 0U);
    const auto count = bytes.take<std::uint32_t>();
    Report report;
    for (std::uint32_t i = 0; i < count; ++i) {
        const auto id = bytes.take<std::uint32_t>();
        const auto v = bytes.take<std::array<double, 18>>();
        const TritriExpected& expected = answers.at(id);
        if (!std::all_of(v.begin(), v.end(),
                         [](double x) { return std::fabs(x) <= kCoordinateMmMax; })) {
            ++(expected.answer == 'R' ? report.refused : report.outside);
            continue;
        }
        sat::TrianglePair<double> p;
        double most[3] = {0, 0, 0};
        for (std::size_t at = 0; at < 6; ++at) {
            const double* const q = &v[3 * at];
            (at < 3 ? p.a[at] : p.b[at - 3]) = {q[0] - v[0], q[1] - v[1], q[2] - v[2]};
            for (std::size_t k = 0; k < 3; ++k) {
                most[k] = std::max(most[k], std::fabs(q[k] - v[k]));
            }
        }
        p.scale = {sat::scale_of(most[0], 0.0), sat::scale_of(most[1], 0.0),
                   sat::scale_of(most[2], 0.0)};
        const sat::PairAxes<double> x = sat::axes_of(p);
        const sat::V3<double> direction = sat::closest_direction(p, x).direction;
        const bool apart =
            sat::separated_17_wide<false>(p, x, 0.0) || sat::separates<false>(p, direction, 0.0);
        const double certified = sat::certified_distance(p, direction);
        if (expected.answer == '1') {
            ++report.intersecting;
            EXPECT_FALSE(apart) << id << ": a missed contact";
            EXPECT_LE(certified, 0) << id;
            continue;
        }
        ++report.apart;
        EXPECT_LE(certified, std::nextafter(expected.distance_mm, HUGE_VAL)) << id;
        report.undecided_mm = std::max(report.undecided_mm, apart ? 0 : expected.distance_mm);
        report.too_short(expected.distance_mm - std::max(certified, 0.0),
                         std::max({most[0], most[1], most[2]}));
    }
    report.print("pairs_f64.bin");
    EXPECT_GT(report.intersecting, 1000U);
    EXPECT_LE(report.undecided_mm, 1e-6);
    EXPECT_LE(report.short_share, kShortShare);
}

}  // namespace
}  // namespace axg::test
