// SPDX-License-Identifier: Apache-2.0
// An engine that poses the parts of boxes itself gets the queries that the prover would have posed,
// bit by bit, and the prover comes to the same results. AXG_COUNT: machines.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <random>
#include <vector>

#include "core/certificate/staged_proof.hpp"
#include "core/collision/query_tree.hpp"
#include "tests/support/count.hpp"
#include "tests/support/seed.hpp"
#include "tests/support/triangle_cases.hpp"

namespace axg::test {
namespace {

using Random = std::mt19937_64;

/// Judges by the bits of a query: one bit else, and the result may be another.
struct HashEngine {
    std::uint64_t salt = 0;
    double far_share = 0.7;
    std::uint32_t turned = 0;  // ablation: these bits of a part's place are the wrong way round
    std::vector<Query> queries{};
    std::uint32_t calls_of_parts = 0;

    static void mix(std::uint64_t& hash, const void* from, std::size_t bytes) {
        const auto* byte = static_cast<const unsigned char*>(from);
        for (std::size_t i = 0; i < bytes; ++i) {
            hash = (hash ^ byte[i]) * 0x100000001b3U;
        }
    }
    [[nodiscard]] QueryResult judge(const Query& q) const {
        std::uint64_t hash = 0xcbf29ce484222325U ^ salt;
        mix(hash, &q.pose, sizeof q.pose);
        mix(hash, &q.r_mm, sizeof q.r_mm);
        mix(hash, &q.pose_error_mm, sizeof q.pose_error_mm);
        mix(hash, &q.mesh_a, sizeof q.mesh_a);
        mix(hash, &q.mesh_b, sizeof q.mesh_b);
        hash ^= hash >> 29U;
        const double share = static_cast<double>(hash % 1024) / 1024;
        return {.status = QueryStatus::ok,
                .proof = share < far_share ? Proof::far : Proof::not_proven};
    }
    static void run_groups(void* self, std::span<const Query> queries,
                           std::span<QueryResult> results, std::span<GroupWork>) noexcept {
        HashEngine& own = *static_cast<HashEngine*>(self);
        for (std::size_t i = 0; i < queries.size(); ++i) {
            own.queries.push_back(queries[i]);
            results[i] = own.judge(queries[i]);
        }
    }
    static void run_parts(void* self, const PartQueries& parts, std::span<const Query> queries,
                          std::span<QueryResult> results, std::span<GroupWork> groups) noexcept {
        HashEngine& own = *static_cast<HashEngine*>(self);
        ++own.calls_of_parts;
        const std::uint32_t mask = (1U << parts.depth) - 1;
        for (std::uint32_t i = 0; i < parts.count(); ++i) {
            const TreeRoot& root = parts.roots[i >> parts.depth];
            Query query;
            const bool is_far = part_query(
                {parts.trees[root.tree], root, parts.depth, (i ^ own.turned) & mask}, query);
            results[i] = own.judge(query);
            if (is_far) {
                results[i] = {.status = QueryStatus::ok, .proof = Proof::far};
            } else {
                own.queries.push_back(query);
            }
        }
        run_groups(self, queries, results.subspan(parts.count()), groups);
    }
    Engine engine(bool poses) {
        Engine out{.self = this,
                   .run = [](void*, std::span<const Query>, std::span<QueryResult>) noexcept {},
                   .prefers_batches = true,
                   .run_groups = run_groups};
        if (poses) {
            out.run_parts = run_parts;
            out.parts_max = 4096;
        }
        return out;
    }
};

Vec3d direction(Random& random) {
    const Pose turn = random_turn(random);
    return {turn.r[0][0], turn.r[1][0], turn.r[2][0]};
}

/// Two chains of joints, some of them along the same axes.
Machine random_machine(Random& random) {
    Machine m;
    m.axes.resize(1 + random() % 6);
    for (std::size_t i = 0; i < m.axes.size(); ++i) {
        m.axes[i].kind = random() % 2 == 0 ? AxisKind::linear : AxisKind::rotary;
        m.axes[i].unlimited = random() % 5 == 0;
        m.travel.low[i] = between(random, -40, -1);
        m.travel.high[i] = between(random, 1, 40);
    }
    m.travel.proofs.resize(random() % 3 == 0 ? 0 : 1);
    const std::size_t bodies = 2 + random() % 6;
    for (std::size_t i = 0; i < bodies; ++i) {
        Body body;
        body.parent = i < 2 ? kNoIndex : static_cast<std::uint32_t>(i - 1 - random() % 2);
        if (random() % 8 != 0) {
            body.joint.axis = static_cast<std::uint32_t>(random() % m.axes.size());
            body.joint.direction = direction(random);
            body.joint.pivot_mm = {between(random, -200, 200), between(random, -200, 200),
                                   between(random, -200, 200)};
        }
        body.at = random_turn(random);
        body.at.t[0] = between(random, -300, 300);
        m.bodies.push_back(body);
    }
    return m;
}

struct Case {
    Machine machine;
    BodyExtent extent;
    std::vector<JointBoxTask> tasks;
    std::vector<std::vector<JointBox>> pieces;
    CyclePlan plan;

    explicit Case(Random& random) : machine(random_machine(random)) {
        extent.radius_mm = between(random, 1, 100);
        const auto last = static_cast<std::uint32_t>(machine.bodies.size() - 1);
        JointBox box;
        for (std::size_t i = 0; i < machine.axes.size(); ++i) {
            box.centre[i] = between(random, -30, 30);
            box.half[i] = random() % 5 == 0 ? 0 : std::exp2(between(random, -12, 4));
        }
        pieces.resize(1 + random() % 5);
        for (std::uint32_t i = 0; i < pieces.size(); ++i) {
            JointBoxTask t;
            t.body_a = last;
            t.body_b = static_cast<std::uint32_t>(random() % last);
            t.mesh_a = 4 * i + 1;
            t.mesh_b = 4 * i + 2;
            t.extent_a = t.extent_b = &extent;
            t.at_a = machine.bodies[t.body_a].at;
            t.at_b = machine.bodies[t.body_b].at;
            t.path = path_between(machine, t.body_a, t.body_b);
            t.margin_mm = between(random, 0, 2);
            t.box = box;
            t.pruned.up_to_mm = random() % 2 == 0 ? -1 : 1;
            t.pruned.is_apart = random() % 4 == 0;
            t.pruned.mesh_a = 4 * i + 3;
            t.pruned.mesh_b = 4 * i + 4;
            if (random() % 6 == 0) {  // a path in three pieces: the prover poses it
                pieces[i].assign(3, box);
                t.pieces = pieces[i];
            }
            tasks.push_back(t);
        }
        const auto queries = std::uint32_t{16} << random() % 6;
        plan = plan_of(random() % 2 == 0 ? 2 : 3, static_cast<std::uint32_t>(tasks.size()), queries,
                       {1000, 1000, 1000, 1000, 0});
    }
    /// @param of_host  stages that `engine` answers as one on the host
    std::vector<JointBoxResult> prove(HashEngine& engine, bool poses, StagedWork& work,
                                      std::uint32_t of_host = 0) const {
        std::vector<JointBoxResult> results(tasks.size());
        auto prover =
            StagedProver::create(machine, static_cast<std::uint32_t>(tasks.size()), plan, kNoIndex);
        Engine asked = engine.engine(poses);
        asked.host = {of_host, &engine, HashEngine::run_groups};
        work = prover->prove(asked, tasks, results);
        return results;
    }
    [[nodiscard]] bool counts_alike() const {  // what is far without a query counts as one
        return std::none_of(tasks.begin(), tasks.end(),
                            [](const JointBoxTask& t) { return t.pruned.is_apart; });
    }
};

bool is_alike(const JointBoxResult& a, const JointBoxResult& b) {
    return a.proof == b.proof && a.status == b.status && a.open.centre == b.open.centre &&
           a.open.half == b.open.half;
}

bool is_alike(const Query& a, const Query& b) {
    return a.kind == b.kind && a.is_float_only == b.is_float_only && a.group == b.group &&
           a.mesh_a == b.mesh_a && a.mesh_b == b.mesh_b && a.r_mm == b.r_mm &&
           a.pose_error_mm == b.pose_error_mm && std::memcmp(&a.pose, &b.pose, sizeof a.pose) == 0;
}

TEST(PosedParts, AreTheQueriesThatTheProverPoses) {
    Random random(printed_seed(20261128));
    std::uint32_t posed = 0, queries = 0, pruned = 0, open = 0;
    const auto count = static_cast<std::uint32_t>(count_from_environment(400));
    for (std::uint32_t n = 0; n < count; ++n) {
        const Case c(random);
        HashEngine told{.salt = random(), .far_share = between(random, 0.3, 1)};
        HashEngine posing = told;
        StagedWork told_work, posing_work;
        const auto wanted = c.prove(told, false, told_work);
        const auto found = c.prove(posing, true, posing_work);
        for (std::size_t i = 0; i < wanted.size(); ++i) {
            ASSERT_TRUE(is_alike(wanted[i], found[i])) << "machine " << n << ", task " << i;
            open += wanted[i].proof == JointBoxProof::budget_spent ? 1 : 0;
        }
        for (std::uint32_t of_host = 1; of_host <= c.plan.stages; ++of_host) {
            HashEngine shared{.salt = told.salt, .far_share = told.far_share};
            StagedWork shared_work;
            const auto same = c.prove(shared, true, shared_work, of_host);
            for (std::size_t i = 0; i < wanted.size(); ++i) {
                ASSERT_TRUE(is_alike(wanted[i], same[i]))
                    << "machine " << n << ", task " << i << ", " << of_host << " on the host";
            }
        }
        ASSERT_EQ(told_work.calls, posing_work.calls);
        ASSERT_TRUE(std::equal(told.queries.begin(), told.queries.end(), posing.queries.begin(),
                               posing.queries.end(),
                               [](const Query& a, const Query& b) { return is_alike(a, b); }))
            << "machine " << n;
        if (c.counts_alike()) {
            ASSERT_EQ(told_work.queries, posing_work.queries);
            for (std::size_t i = 0; i < wanted.size(); ++i) {
                ASSERT_EQ(wanted[i].queries, found[i].queries);
            }
        }
        posed += posing.calls_of_parts;
        queries += posing_work.queries;
        pruned += static_cast<std::uint32_t>(
            std::count_if(posing.queries.begin(), posing.queries.end(),
                          [](const Query& q) { return q.mesh_a % 4 == 3; }));
    }
    std::printf("%u machines: %u queries, %u calls posed, %u pruned, %u tasks open\n", count,
                queries, posed, pruned, open);
    EXPECT_GT(posed, count / 4);
    EXPECT_GT(pruned, 0U);
    EXPECT_GT(open, 0U);
}

// Ablation: with one cut the wrong way round the same boxes are asked about in another order, and
// results belong to other boxes than the prover says.
TEST(PosedParts, APlaceReadTheWrongWayRoundIsFoundOut) {
    Random random(printed_seed(20261128));
    std::uint32_t differ = 0, tried = 0;
    for (std::uint32_t n = 0; n < 100; ++n) {
        const Case c(random);
        HashEngine told{.salt = random(), .far_share = 0.7};
        HashEngine posing = told;
        posing.turned = 1;
        StagedWork work;
        const auto wanted = c.prove(told, false, work);
        const auto found = c.prove(posing, true, work);
        tried += posing.calls_of_parts != 0 ? 1 : 0;
        differ += std::equal(wanted.begin(), wanted.end(), found.begin(),
                             [](const auto& a, const auto& b) { return is_alike(a, b); })
                      ? 0
                      : 1;
    }
    EXPECT_GT(differ, tried / 4);
}

}  // namespace
}  // namespace axg::test
