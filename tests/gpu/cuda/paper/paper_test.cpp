// SPDX-License-Identifier: Apache-2.0
// The paper's kernels on the GPU find what the same arithmetic finds on the CPU: every choice of
// techniques that is compiled, on random bodies in contact and apart. AXG_COUNT queries.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <optional>
#include <utility>

#include "core/collision/cpu_engine.hpp"
#include "cuda/paper/brute_cpu.hpp"
#include "cuda/paper/paper_gpu.hpp"
#include "tests/support/cuda_fixture.hpp"
#include "tests/support/random_queries.hpp"
#include "tests/support/seed.hpp"

namespace axg::paper {
namespace {

using test::Draw;

/// Balls of 588 and 1,728 triangles and a plate, in light and deep contact and apart; each placed
/// twice, a hundredth of a millimetre apart, so that axes are carried over.
struct Fixture {
    Scene scene;
    std::vector<PairPose> queries;
    std::optional<Gpu> gpu;
    std::string fault;

    Fixture() {
        Draw draw(test::printed_seed(11));
        for (const Mesh& mesh :
             {test::lumpy_ball(draw, 7, 60, 0.1), test::lumpy_ball(draw, 12, 50, 0.4),
              test::plate(8, 8, 64), test::lumpy_ball(draw, 1, 20, 0.3)}) {
            scene.bodies.push_back(make_body(mesh.triangles));
        }
        scene.pairs = {{0, 1}, {1, 2}, {2, 0}, {3, 1}};
        // Whole launches of eight queries.
        const std::uint32_t count =
            4 * std::clamp(test::number_from("AXG_COUNT", 200) / 4, 1U, 250U);
        for (std::uint32_t i = 0; i < count; ++i) {
            PairPose query{i % 4, test::random_rotation(draw)};
            const Pose direction = test::random_rotation(draw);
            const double away = draw.between(0, 130);
            for (int k = 0; k < 3; ++k) {
                query.pose.t[k] = away * direction.r[k][0];
            }
            queries.push_back(query);
            query.pose.t[0] += 0.01;
            queries.push_back(query);
        }
        if (auto made = Gpu::create(scene, test::number_from("AXG_SMS", 0), fault)) {
            gpu.emplace(std::move(*made));
        }
    }

    /// What the CPU finds, `test` being one of brute_cpu.hpp's.
    template <class Test>
    [[nodiscard]] std::vector<Found> on_cpu(const Test& test) const {
        std::vector<Found> found;
        for (const PairPose& query : queries) {
            const BodyPair& pair = scene.pairs[query.pair];
            found.push_back(test(scene.bodies[pair.a], scene.bodies[pair.b], query.pose));
        }
        return found;
    }
};

TEST(PaperGpu, FindsWhatTheCpuFindsWithEveryTechnique) {
    Fixture fixture;
    if (!fixture.gpu) {
        GTEST_SKIP() << fixture.fault;
    }
    const std::vector<Found> naive = fixture.on_cpu(&test_naively);
    std::vector<Found> found(fixture.queries.size());
    std::vector<double> us(fixture.queries.size());
    unsigned compiled = 0;
    for (unsigned bits = 0; bits < 32; ++bits) {
        const Techniques t{(bits & 1U) != 0, (bits & 2U) != 0, (bits & 4U) != 0, (bits & 8U) != 0,
                           (bits & 16U) != 0};
        const Timing timing = bits % 2 == 0 ? Timing::each : Timing::queued;
        if (!fixture.gpu->run_paper(t, timing, 1, fixture.queries, found, us)) {
            ASSERT_NE(fixture.gpu->fault().find("not compiled"), std::string::npos)
                << fixture.gpu->fault();
            continue;
        }
        ++compiled;
        std::uint32_t differ = 0, touching = 0;
        for (std::size_t i = 0; i < found.size(); ++i) {
            differ += found[i].touching != naive[i].touching ? 1 : 0;
            touching += found[i].touching != 0 ? 1 : 0;
            EXPECT_LE(found[i].tested, naive[i].tested);
            EXPECT_GT(us[i], 0);
            if (!t.boxes && !t.interchange) {
                EXPECT_EQ(found[i].tested, naive[i].tested);
            }
        }
        std::printf("techniques %2u: %u of %zu questions touch, counts differ at %u\n", bits,
                    touching, found.size(), differ);
        // A box or another axis may settle a pair that rounding alone had kept; otherwise the
        // arithmetic is the same to the bit.
        EXPECT_LE(differ, t.boxes || t.interchange || t.carry ? found.size() / 100 : 0U) << bits;
        EXPECT_GT(touching, 0U);
    }
    EXPECT_EQ(compiled, 20U);
}

TEST(PaperGpu, CertifiesWhatTheCpuCertifies) {
    Fixture fixture;
    if (!fixture.gpu) {
        GTEST_SKIP() << fixture.fault;
    }
    const std::vector<Found> certified =
        fixture.on_cpu([](const Body& a, const Body& b, const Pose& pose) {
            return test_certified(*lane_kernels(LaneSet::widest), a, b, pose);
        });
    std::vector<double> us(fixture.queries.size());
    for (const std::uint32_t together : {1U, 2U, 8U}) {
        std::vector<Found> found(fixture.queries.size());
        ASSERT_TRUE(fixture.gpu->run_certified(together == 2 ? Timing::queued : Timing::each,
                                               together, fixture.queries, found, us))
            << fixture.gpu->fault();
        for (std::size_t i = 0; i < found.size(); ++i) {
            EXPECT_EQ(found[i].touching, certified[i].touching) << i;
            EXPECT_EQ(found[i].tested, certified[i].tested) << i;
            EXPECT_GE(found[i].left, found[i].touching) << i;
        }
    }
}

TEST(PaperGpu, KernelsFitTheirBlocks) {
    Fixture fixture;
    if (!fixture.gpu) {
        GTEST_SKIP() << fixture.fault;
    }
    for (const KernelFacts& kernel : fixture.gpu->kernels()) {
        std::printf("%s: %d registers, %zu bytes shared, %zu bytes local\n", kernel.name.c_str(),
                    kernel.registers, kernel.shared_bytes, kernel.local_bytes);
        EXPECT_GT(kernel.registers, 0) << kernel.name;
    }
}

}  // namespace
}  // namespace axg::paper
