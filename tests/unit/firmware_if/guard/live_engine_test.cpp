// SPDX-License-Identifier: Apache-2.0
// The engine's side of the live guard's queues: a result leaves before the speed cap of the next
// one is looked for, and that is the next one's.
#include "firmware_if/guard/live_engine.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <vector>

#include "hil_replay/gcode/gcode_reader.hpp"
#include "tests/support/replay_fixture.hpp"

namespace axg {
namespace {

TEST(LiveEngine, APermitWaitsForNoSpeedCap) {
    test::PaperMachine paper;
    const Machine& machine = paper.loaded.machine;
    std::optional<StopCertificate> certificate = make_stop_certificate(paper.loaded);
    std::optional<SpeedAdvisory> advisory = SpeedAdvisory::create(machine);
    ASSERT_TRUE(paper.engine && paper.containment_test && certificate && advisory);
    GuardChain chain(machine, paper.engine->engine(), *paper.containment_test,
                     {&*certificate, &*advisory});
    const LiveEngine live{machine, chain};
    const auto queues = std::make_unique<LiveQueues>();
    LiveQuery query;
    query.kind = LiveQuery::Kind::snapshot;
    query.event.kind = ReceiverEvent::Kind::snapshot;
    query.event.state = ReceiverState::valid;
    AxisSnapshot& snapshot = query.event.snapshot;
    snapshot.axis_count = static_cast<std::uint32_t>(machine.axes.size());
    snapshot.position = default_start(machine);
    snapshot.tool = machine.first_tool;
    snapshot.mode = kModeStandstill;
    std::uint8_t found = 0;  // after the result before
    std::vector<std::uint8_t> caps;
    for (std::uint32_t i = 1; i <= 2 * kSamplesKept; ++i) {
        query.number = i;
        snapshot.sample = i;
        ASSERT_TRUE(queues->queries.push(query));
        run_queries(live, *queues, [&](const LiveResult& live_result) {
            EXPECT_EQ(live_result.number, i);
            EXPECT_EQ(live_result.result.advisories.speed_cap, found);
            EXPECT_EQ(advisory->cap(), found) << "not looked for before the answer is out";
            caps.push_back(live_result.result.advisories.speed_cap);
        });
        found = advisory->cap();
    }
    ASSERT_EQ(caps.size(), 2 * kSamplesKept);
    EXPECT_EQ(caps[kSamplesKept - 1], 0) << "too little is known yet";
    EXPECT_EQ(caps.back(), kSpeedCapRapid);
}

/// A GPU in place of which a CPU engine answers, and how often it was called.
struct CountedGpu {
    Engine engine;
    std::uint32_t calls = 0;

    [[nodiscard]] Engine counted() {
        Engine out{.self = this, .prefers_batches = true};
        out.run = [](void* self, std::span<const Query> queries,
                     std::span<QueryResult> results) noexcept {
            auto& own = *static_cast<CountedGpu*>(self);
            ++own.calls;
            own.engine(queries, results);
        };
        out.run_groups = [](void* self, std::span<const Query> queries,
                            std::span<QueryResult> results, std::span<GroupWork> groups) noexcept {
            auto& own = *static_cast<CountedGpu*>(self);
            ++own.calls;
            own.engine(queries, results, groups);
        };
        return out;
    }
};

/// A CPU engine to which the pair of its first query is near.
struct NearHost {
    Engine engine;
    std::uint32_t mesh_a = kNoIndex, mesh_b = kNoIndex;

    static void run_groups(void* self, std::span<const Query> queries,
                           std::span<QueryResult> results, std::span<GroupWork> groups) noexcept {
        NearHost& host = *static_cast<NearHost*>(self);
        host.engine(queries, results, groups);
        if (host.mesh_a == kNoIndex && queries.size() > 2) {  // not the known-answer test alone
            host.mesh_a = queries[0].mesh_a;
            host.mesh_b = queries[0].mesh_b;
        }
        for (std::size_t i = 0; i < queries.size(); ++i) {
            if (queries[i].mesh_a == host.mesh_a && queries[i].mesh_b == host.mesh_b) {
                results[i] = {.status = QueryStatus::ok};
            }
        }
    }
};

// A GPU without work would sleep: where the host answered every stage, or its first part lost the
// last one, it is called when the permit is out.
TEST(LiveEngine, AGpuThatNoStageWentToIsKeptAwake) {
    test::PaperMachine paper;
    const Machine& machine = paper.loaded.machine;
    enum class Case { all_of_gpu, far, lost_by_first_part };
    for (const Case at : {Case::all_of_gpu, Case::far, Case::lost_by_first_part}) {
        const std::uint32_t of_host = at == Case::all_of_gpu ? 0 : 2;
        std::optional<StopCertificate> certificate = make_stop_certificate(paper.loaded);
        ASSERT_TRUE(paper.engine && paper.containment_test && certificate);
        CountedGpu gpu{paper.engine->engine()};
        NearHost near{.engine = gpu.engine};
        Engine engine = gpu.counted();
        engine.host = {of_host, gpu.engine.self, gpu.engine.run_groups};
        if (at == Case::lost_by_first_part) {
            engine.host = {of_host, &near, NearHost::run_groups};
        }
        GuardChain chain(machine, engine, *paper.containment_test, {&*certificate});
        ReceiverEvent event;
        event.kind = ReceiverEvent::Kind::snapshot;
        event.state = ReceiverState::valid;
        event.snapshot.axis_count = static_cast<std::uint32_t>(machine.axes.size());
        event.snapshot.position = default_start(machine);
        event.snapshot.tool = machine.first_tool;
        std::uint32_t most_stages = 0;
        for (std::uint32_t i = 1; i <= 2 * kSamplesKept; ++i) {
            event.snapshot.sample = i;
            chain.take(event);
            const std::uint32_t before = gpu.calls;
            chain.evaluate();
            static_cast<void>(chain.decide(true, true));
            EXPECT_EQ(gpu.calls - before, of_host == 0 ? 1U : 0U) << i;
            const std::uint32_t decided = gpu.calls;
            chain.update_advisories();
            EXPECT_EQ(gpu.calls - decided, of_host == 0 ? 0U : 1U) << i;
            most_stages = std::max(most_stages, certificate->work().stages);
        }
        EXPECT_EQ(most_stages, at == Case::lost_by_first_part ? 3U : 1U);
    }
}

}  // namespace
}  // namespace axg
