// SPDX-License-Identifier: Apache-2.0
// An engine that answers as it is told to, and slides past fixed bodies for the prover in stages.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "core/certificate/staged_proof.hpp"

namespace axg::test {

inline constexpr std::uint32_t kKnownAnswerMesh = 77;
inline constexpr WorkLists kAmple{1U << 20U, 1U << 20U, 1U << 20U, 1U << 20U, 1U << 20U};

/// Judges each query as it is told to, and keeps what it saw.
struct ToldEngine {
    std::function<Proof(const Query&)> judge;
    bool prefers_batches = false;
    std::function<void(std::uint32_t call, std::span<const Query>, std::span<QueryResult>,
                       std::span<GroupWork>)>
        spoil = {};
    std::vector<std::vector<Query>> calls{};
    std::vector<std::vector<GroupWork>> groups{};

    [[nodiscard]] std::uint32_t queries() const {
        std::uint32_t sum = 0;
        for (const std::vector<Query>& call : calls) {
            sum += static_cast<std::uint32_t>(call.size());
        }
        return sum;
    }
    static void run(void* self, std::span<const Query> queries, std::span<QueryResult> results,
                    std::span<GroupWork> groups) noexcept {
        ToldEngine& fake = *static_cast<ToldEngine*>(self);
        for (std::size_t i = 0; i < queries.size(); ++i) {
            const bool is_known = queries[i].mesh_a == kKnownAnswerMesh;
            const Proof proof = is_known ? queries[i].pose.t[0] > 1 ? Proof::far : Proof::not_proven
                                         : fake.judge(queries[i]);
            results[i] = QueryResult{.status = QueryStatus::ok, .proof = proof};
        }
        if (fake.spoil) {
            fake.spoil(static_cast<std::uint32_t>(fake.calls.size()), queries, results, groups);
        }
        fake.calls.emplace_back(queries.begin(), queries.end());
        fake.groups.emplace_back(groups.begin(), groups.end());
    }
    Engine engine() {
        return {
            .self = this,
            .run = [](void* self, std::span<const Query> queries,
                      std::span<QueryResult> results) noexcept { run(self, queries, results, {}); },
            .prefers_batches = prefers_batches,
            .run_groups = run};
    }
};

/// Far to margins up to this.
inline ToldEngine far_to(double mm) {
    return {.judge = [mm](const Query& query) {
        return query.r_mm <= mm ? Proof::far : Proof::not_proven;
    }};
}

/// Slides along x, each past a fixed body; a box of 16 mm that is proven in parts of 2 mm.
struct Slides {
    Machine machine;
    BodyExtent extent;
    std::vector<JointBoxTask> tasks;
    std::vector<JointBoxResult> results;
    StagedWork work;

    explicit Slides(std::uint32_t count = 1) : tasks(count), results(count) {
        machine.axes.resize(1);
        machine.bodies.resize(2);
        machine.bodies[1].joint = {0, {1, 0, 0}, {}};
        extent.radius_mm = 1;
        for (std::uint32_t i = 0; i < count; ++i) {
            tasks[i].body_a = 1;
            tasks[i].mesh_a = i + 1;
            tasks[i].extent_a = tasks[i].extent_b = &extent;
            tasks[i].path = path_between(machine, 1, 0);
            tasks[i].margin_mm = 0.5;
            tasks[i].box.half[0] = 8;
        }
    }
    static CyclePlan plan(std::uint32_t stages, TreeForm form, std::uint32_t queries) {
        CyclePlan out{.stages = stages, .form = form};
        out.queries = {8, queries, queries};
        out.lists.fill(kAmple);
        return out;
    }
    void prove(ToldEngine& fake, const CyclePlan& plan, std::uint32_t mesh = kNoIndex) {
        auto prover =
            StagedProver::create(machine, static_cast<std::uint32_t>(tasks.size()), plan, mesh);
        work = prover->prove(fake.engine(), tasks, results);
    }
};

}  // namespace axg::test
