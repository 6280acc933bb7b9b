// SPDX-License-Identifier: Apache-2.0
// What is no number is refused by its bits at every door: vertices of an STL file and of an
// engine's mesh, poses, margins, pairs of the laboratory. Quiet and signalling, any payload, either
// sign. Positions: tests/unit/core/certificate/pair_queries_test.cpp. Beside each door the largest
// number gets through, so that it is not simply shut.
#include "core/base/finite.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include "core/mesh/stl.hpp"
#include "hil_replay/lab/cases/tritri_file.hpp"
#include "hil_replay/lab/methods/method.hpp"
#include "tests/support/engine_fixture.hpp"
#include "tests/support/not_finite.hpp"
#include "tests/support/solids.hpp"

namespace axg::test {
namespace {

TEST(Finite, TellsByTheBits) {
    for (const std::uint32_t bits : kNotFiniteFloatBits) {
        EXPECT_FALSE(is_finite(float_of(bits))) << std::hex << bits;
    }
    for (const std::uint64_t bits : kNotFiniteDoubleBits) {
        EXPECT_FALSE(is_finite(double_of(bits))) << std::hex << bits;
    }
    for (const float x : {0.0F, -0.0F, 0x1p-149F, std::numeric_limits<float>::max(),
                          std::numeric_limits<float>::lowest()}) {
        EXPECT_TRUE(is_finite(x)) << x;
    }
    for (const double x : {0.0, -0.0, 0x1p-1074, std::numeric_limits<double>::max(),
                           std::numeric_limits<double>::lowest()}) {
        EXPECT_TRUE(is_finite(x)) << x;
    }
}

TEST(Finite, NoVertexOfABinaryStl) {
    const std::vector<std::byte> good = write_stl(box({0, 0, 0}, {10, 20, 30}));
    for (const std::uint32_t bits : kNotFiniteFloatBits) {
        for (std::size_t k = 0; k < 9; ++k) {
            std::vector<std::byte> bytes = good;
            std::memcpy(bytes.data() + kStlHeaderBytes + kStlFacetBytes * 3 + 12 + 4 * k, &bits, 4);
            const StlResult result = read_stl(bytes, 1.0);
            ASSERT_EQ(result.fault_count, 1U) << std::hex << bits << " " << k;
            EXPECT_EQ(result.faults[0].kind, StlFaultKind::not_finite);
            EXPECT_TRUE(result.triangles.empty());
        }
    }
    EXPECT_EQ(read_stl(good, 1.0).triangles.size(), 12U);
}

float* coordinate_of(Triangle& t, std::size_t k) {
    Vec3f& v = k < 3 ? t.a : k < 6 ? t.b : t.c;
    return k % 3 == 0 ? &v.x : k % 3 == 1 ? &v.y : &v.z;
}

TEST(Finite, NoVertexOfAMesh) {
    const Mesh good{"box", box({-1, -1, -1}, {1, 1, 1})};
    Query q{.mesh_a = 0, .mesh_b = 1, .pose = shifted(10, 0, 0)};
    for (const std::uint32_t bits : kNotFiniteFloatBits) {
        for (std::size_t k = 0; k < 9; ++k) {
            Mesh bad = good;
            *coordinate_of(bad.triangles[7], k) = float_of(bits);
            for (const auto& meshes : {std::vector<Mesh>{bad, good}, {good, bad}}) {
                CpuEngine engine = *engine_over(meshes);
                const QueryResult result = run_query(engine, q);
                EXPECT_EQ(result.status, QueryStatus::bad_query) << std::hex << bits;
                EXPECT_EQ(result.proof, Proof::not_proven);
            }
        }
    }
    CpuEngine engine = *engine_over({good, good});
    EXPECT_EQ(run_query(engine, q).proof, Proof::far);
}

TEST(Finite, NoNumberOfAQuery) {
    const Mesh mesh{"box", box({-1, -1, -1}, {1, 1, 1})};
    CpuEngine engine = *engine_over({mesh, mesh});
    for (const QueryKind what : {QueryKind::farther, QueryKind::touching, QueryKind::clearance}) {
        for (const std::uint64_t bits : kNotFiniteDoubleBits) {
            for (int at = 0; at < 14; ++at) {
                Query q{
                    .kind = what, .mesh_a = 0, .mesh_b = 1, .r_mm = 1, .pose = shifted(10, 0, 0)};
                double* const field = at < 9    ? &q.pose.r[at / 3][at % 3]
                                      : at < 12 ? &q.pose.t[at - 9]
                                      : at < 13 ? &q.r_mm
                                                : &q.pose_error_mm;
                *field = double_of(bits);
                const QueryResult result = run_query(engine, q);
                EXPECT_EQ(result.status, QueryStatus::bad_query) << std::hex << bits << at;
                EXPECT_EQ(result.proof, Proof::not_proven);
                EXPECT_EQ(result.clearance_mm, 0);
            }
        }
    }
}

TEST(Finite, NoPairOfTheLaboratory) {
    lab::PairSet floats, doubles, posed;
    for (const std::uint32_t bits : kNotFiniteFloatBits) {
        lab::Pair<float> pair{{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}}, {{1, 1, 9}, {4, 2, 9}, {1, 4, 8}}};
        pair.b[floats.size() % 3].y = float_of(bits);
        floats.add(pair);
    }
    const lab::Pair<double> good{{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}},
                                 {{1, 1, 9}, {4, 2, 9}, {1, 4, 8}}};
    for (const std::uint64_t bits : kNotFiniteDoubleBits) {
        lab::Pair<double> pair = good;
        pair.a[doubles.size() % 3].x = double_of(bits);
        doubles.add(pair);
        Pose pose;
        (posed.size() % 2 == 0 ? pose.t[1] : pose.r[2][1]) = double_of(bits);
        posed.add(good, pose);
    }
    for (const lab::PairSet* const set : {&floats, &doubles, &posed}) {
        for (const lab::Fitness fitness : set->fitness) {
            EXPECT_EQ(fitness, lab::Fitness::rejected);
        }
    }
    doubles.add(good);
    EXPECT_EQ(doubles.fitness.back(), lab::Fitness::usable);
}

/// A file of pairs as data/tritri has them, one pair for each pattern of bits.
std::string accuracy_file() {
    std::string out = "TTP1";
    const auto put = [&out](const auto& value) {
        out.append(reinterpret_cast<const char*>(&value), sizeof value);
    };
    put(std::uint32_t{4});
    put(std::uint32_t{0});
    put(static_cast<std::uint32_t>(kNotFiniteFloatBits.size()));
    for (std::uint32_t i = 0; i < kNotFiniteFloatBits.size(); ++i) {
        put(i);
        for (std::uint32_t k = 0; k < 18; ++k) {
            put(k == i ? kNotFiniteFloatBits[i] : std::bit_cast<std::uint32_t>(float(k * k)));
        }
    }
    return out;
}

TEST(Finite, NoPairOfAFileOfCases) {
    lab::TritriFile file;
    ASSERT_EQ(lab::parse_tritri(accuracy_file(), file), "");
    ASSERT_EQ(file.pairs.size(), kNotFiniteFloatBits.size());
    for (const lab::Method& method : lab::methods()) {
        for (const lab::Verdict verdict : lab::judge(method, file.pairs, false).verdicts) {
            EXPECT_EQ(verdict, lab::Verdict::rejected) << method.name;
        }
    }
}

}  // namespace
}  // namespace axg::test
