// SPDX-License-Identifier: Apache-2.0
// Queries in groups are charged by the GPU what the CPU charges, and lose what the CPU loses where
// it takes no early exit: the same sums, the same results, group by group. Where lists are full the
// GPU proves nothing that the CPU does not, and says the same again each time. AXG_COUNT: batches.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <vector>

#include "tests/support/cuda_fixture.hpp"
#include "tests/support/engine_fixture.hpp"
#include "tests/support/engine_parity.hpp"
#include "tests/support/random_queries.hpp"
#include "tests/support/seed.hpp"

namespace axg {
namespace {

constexpr std::uint32_t kAmple = 1U << 30U;
constexpr WorkLists kAmpleShare{kAmple, kAmple, kAmple, kAmple, kAmple};
constexpr std::uint32_t WorkLists::*kLists[] = {&WorkLists::node_pairs, &WorkLists::leaf_pairs,
                                                &WorkLists::box_rows, &WorkLists::triangle_pairs,
                                                &WorkLists::rechecks};
constexpr QueryStatus kFull[] = {QueryStatus::too_many_node_pairs, QueryStatus::too_many_leaf_pairs,
                                 QueryStatus::too_many_box_rows,
                                 QueryStatus::too_many_triangle_pairs,
                                 QueryStatus::too_many_rechecks};

// Places for all that the CPU counts, whose queries in groups have no capacities.
constexpr Capacities kLong{.rechecks = 1U << 16U};

CudaOptions long_lists() {
    CudaOptions options;
    options.level_pairs = 1U << 20U;
    options.leaf_pairs = 1U << 22U;
    options.candidates = 1;
    return options;
}

struct Outcome {
    std::vector<QueryResult> results;
    std::vector<GroupWork> groups;
};

template <class AnyEngine>
Outcome run(AnyEngine& engine, const std::vector<Query>& queries, std::vector<GroupWork> groups) {
    Outcome out{std::vector<QueryResult>(queries.size()), std::move(groups)};
    engine.run(queries, out.results, out.groups);
    return out;
}

class CudaGroups : public testing::Test {
  protected:
    void draw_batch(std::uint32_t size, std::uint32_t groups) {
        queries.resize(size);
        for (Query& q : queries) {
            q = test::random_query(draw, static_cast<std::uint32_t>(meshes.size()));
            q.kind = q.kind == QueryKind::clearance ? QueryKind::farther : q.kind;
            q.r_mm = q.kind == QueryKind::farther && draw.below(2) == 0 ? 0 : q.r_mm;
            q.is_float_only = draw.below(2) == 0;
            q.group = static_cast<std::uint16_t>(draw.below(groups));
        }
    }
    /// Of a CPU that takes no early exit.
    Outcome counted(const std::vector<GroupWork>& groups) {
        cpu->set_counts_all(true);
        Outcome out = run(*cpu, queries, groups);
        cpu->set_counts_all(false);
        return out;
    }
    void expect_equal(const Outcome& x, const Outcome& y) {
        for (std::size_t i = 0; i < queries.size(); ++i) {
            ASSERT_EQ(test::difference(queries[i].kind, x.results[i], y.results[i]), "")
                << "query " << i << "\n"
                << test::text_of(x.results[i]) << "\n"
                << test::text_of(y.results[i]);
            ASSERT_EQ(x.results[i].status, y.results[i].status) << "query " << i;
        }
    }

    test::Draw draw{test::printed_seed(71)};
    std::vector<Mesh> meshes = test::random_surfaces(draw);
    std::optional<CpuEngine> cpu = test::engine_over(meshes);
    std::vector<Query> queries;
};

TEST_F(CudaGroups, AreChargedWhatTheCpuCharges) {
    AXG_CUDA_ENGINE_OR_SKIP(gpu, meshes, kLong, long_lists());
    std::uint64_t far = 0;
    WorkLists most;
    const std::uint32_t count = test::number_from("AXG_COUNT", 12);
    for (std::uint32_t batch = 0; batch < count; ++batch) {
        // More queries than a launch takes, too: their sums add up.
        const std::uint32_t groups = batch % 3 == 0 ? 1 : batch % 3 == 1 ? 4 : 300;
        draw_batch(batch % 4 == 3 ? 700 : 1 + draw.below(200), groups);
        const std::vector<GroupWork> shares(groups, {.share = kAmpleShare});
        const Outcome wanted = counted(shares), found = run(gpu, queries, shares);
        ASSERT_EQ(gpu.fault(), nullptr) << gpu.fault();
        expect_equal(wanted, found);
        for (std::uint32_t g = 0; g < groups; ++g) {
            ASSERT_EQ(found.groups[g].share, kAmpleShare);
            for (std::size_t l = 0; l < std::size(kLists); ++l) {
                ASSERT_EQ(wanted.groups[g].used.*kLists[l], found.groups[g].used.*kLists[l])
                    << "batch " << batch << " group " << g << " list " << l;
                most.*kLists[l] = std::max(most.*kLists[l], found.groups[g].used.*kLists[l]);
            }
        }
        far += static_cast<std::uint64_t>(
            std::count_if(found.results.begin(), found.results.end(),
                          [](const QueryResult& r) { return r.proof == Proof::far; }));
    }
    std::printf("far %llu; most of a group: %u, %u, %u, %u, %u\n",
                static_cast<unsigned long long>(far), most.node_pairs, most.leaf_pairs,
                most.box_rows, most.triangle_pairs, most.rechecks);
    EXPECT_GT(far, 0U);
    for (std::uint32_t WorkLists::*const list : kLists) {
        EXPECT_GT(most.*list, 0U);
    }
}

TEST_F(CudaGroups, OneShortOfAnyListIsLostAndNoOtherNotices) {
    AXG_CUDA_ENGINE_OR_SKIP(gpu, meshes, kLong, long_lists());
    std::uint32_t tried[std::size(kLists)] = {};
    for (const std::uint32_t groups : {1U, 4U, 64U}) {
        for (std::uint32_t round = 0; round < 2; ++round) {
            draw_batch(64, groups);
            const std::vector<GroupWork> ample(groups, {.share = kAmpleShare});
            const Outcome need = counted(ample);
            const std::uint32_t victim = draw.below(groups);
            for (std::size_t l = 0; l < std::size(kLists); ++l) {
                if (need.groups[victim].used.*kLists[l] == 0) {
                    continue;
                }
                ++tried[l];
                for (const bool is_short : {false, true}) {
                    std::vector<GroupWork> shares = ample;
                    for (std::uint32_t g = 0; g < groups; ++g) {
                        shares[g].share = need.groups[g].used;
                    }
                    shares[victim].share = kAmpleShare;
                    shares[victim].share.*kLists[l] =
                        need.groups[victim].used.*kLists[l] - (is_short ? 1 : 0);
                    const Outcome found = run(gpu, queries, shares);
                    ASSERT_EQ(gpu.fault(), nullptr) << gpu.fault();
                    for (std::size_t i = 0; i < queries.size(); ++i) {
                        const bool is_lost = is_short && queries[i].group == victim;
                        ASSERT_EQ(found.results[i].proof,
                                  is_lost ? Proof::not_proven : need.results[i].proof)
                            << "list " << l << " groups " << groups << " query " << i;
                        ASSERT_EQ(found.results[i].status,
                                  is_lost ? kFull[l] : need.results[i].status)
                            << "list " << l << " groups " << groups << " query " << i;
                    }
                }
            }
        }
    }
    for (const std::uint32_t count : tried) {
        EXPECT_GT(count, 1U);
    }
}

TEST_F(CudaGroups, WithListsTooShortProveWhatTheCpuProvesAndNothingElse) {
    AXG_CUDA_ENGINE_OR_SKIP(gpu, meshes, kLong, long_lists());
    const std::uint32_t count = test::number_from("AXG_COUNT", 12);
    std::uint32_t far = 0, lost = 0, lost_by_cpu = 0;
    for (std::uint32_t batch = 0; batch < count; ++batch) {
        const std::uint32_t groups = batch % 3 == 0 ? 1 : batch % 3 == 1 ? 4 : 100;
        draw_batch(1 + draw.below(200), groups);
        std::vector<GroupWork> shares(groups, {.share = kAmpleShare});
        const Outcome need = counted(shares);
        for (std::uint32_t g = 0; g < groups; ++g) {
            for (std::uint32_t WorkLists::*const list : kLists) {
                const std::uint32_t used = need.groups[g].used.*list;
                shares[g].share.*list = draw.below(4) == 0 ? draw.below(used + 1) : used;
            }
        }
        const Outcome found = run(gpu, queries, shares), again = run(gpu, queries, shares);
        const Outcome lazy = run(*cpu, queries, shares);
        ASSERT_EQ(gpu.fault(), nullptr) << gpu.fault();
        for (std::size_t i = 0; i < queries.size(); ++i) {
            const QueryResult &x = found.results[i], &y = again.results[i];
            ASSERT_EQ(x.status, y.status) << "batch " << batch << " query " << i;
            ASSERT_EQ(x.proof, y.proof) << "batch " << batch << " query " << i;
            ASSERT_FALSE(x.proof == Proof::far && lazy.results[i].proof != Proof::far);
            ASSERT_FALSE(x.proof == Proof::far && test::is_overflow(x));
            far += x.proof == Proof::far ? 1 : 0;
            lost += test::is_overflow(x) ? 1 : 0;
            lost_by_cpu += test::is_overflow(lazy.results[i]) ? 1 : 0;
        }
        for (std::uint32_t g = 0; g < groups; ++g) {
            ASSERT_EQ(found.groups[g].used, again.groups[g].used);
            ASSERT_EQ(first_full(found.groups[g]) == QueryStatus::ok,
                      first_full(GroupWork{.share = shares[g].share,
                                           .used = need.groups[g].used}) == QueryStatus::ok);
        }
    }
    std::printf("far %u, lost with their group %u, by the CPU %u\n", far, lost, lost_by_cpu);
    EXPECT_GT(far, 0U);
    EXPECT_GT(lost, 0U);
    EXPECT_LE(lost_by_cpu, lost);
}

TEST_F(CudaGroups, RefuseAClearance) {
    AXG_CUDA_ENGINE_OR_SKIP(gpu, meshes, kLong, long_lists());
    draw_batch(2, 1);
    queries[0].kind = QueryKind::clearance;
    const std::vector<GroupWork> shares(1, {.share = kAmpleShare});
    const Outcome wanted = counted(shares), found = run(gpu, queries, shares);
    EXPECT_EQ(found.results[0].status, QueryStatus::bad_query);
    EXPECT_EQ(found.results[1].proof, wanted.results[1].proof);
}

}  // namespace
}  // namespace axg
