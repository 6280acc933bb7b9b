// SPDX-License-Identifier: Apache-2.0
// After start nothing is allocated: not in a replay from its first frame to its last, stop and
// faults included, not in any query.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <memory>

#include "tests/support/containment_fixture.hpp"
#include "tests/support/engine_fixture.hpp"
#include "tests/support/malloc_count.hpp"
#include "tests/support/random_queries.hpp"
#include "tests/support/replay_fixture.hpp"
#include "tests/support/round_solids.hpp"
#include "tests/support/seed.hpp"
#include "tests/support/simulated_frames.hpp"

namespace axg {
namespace {

using test::allocations;
using test::NoAllocation;

TEST_F(NoAllocation, TheCountSeesEveryWayToAllocate) {
    std::uint64_t before = allocations;
    const auto expect_more = [&before](const char* what) {
        EXPECT_GT(allocations, before) << what;
        before = allocations;
    };
    int* volatile number = new int(1);  // volatile: the compiler may otherwise leave it out
    expect_more("new");
    delete number;
    expect_more("delete");
    void* volatile memory = std::malloc(10);
    expect_more("malloc");
    memory = std::realloc(memory, 100);
    expect_more("realloc");
    std::free(memory);
    expect_more("free");
    memory = std::aligned_alloc(64, 128);
    expect_more("aligned_alloc");
    std::free(memory);
    memory = std::calloc(3, 3);
    std::free(memory);
    std::string text(100, 'x');
    expect_more("string");
}

std::int64_t steady_ns(void*) {
    return std::chrono::steady_clock::now().time_since_epoch().count();
}

TEST_F(NoAllocation, InAReplayFromItsFirstFrameToItsLast) {
    test::PaperMachine paper;
    ASSERT_TRUE(paper.engine.has_value());
    std::vector<CanFrame> frames = test::simulated_frames(paper.loaded.machine, test::kDemoProgram);
    ASSERT_GE(frames.size(), 20'000U);
    for (std::size_t i = 5'000; i < frames.size(); i += 5'000) {
        frames[i].data[3] ^= 1;  // a damaged frame now and then
    }
    frames.erase(frames.end() - 600, frames.end() - 400);  // and lost input at the end
    for (Pair& pair : paper.loaded.machine.pairs) {
        pair.slow_mm = 2;
        pair.warn_mm = 5;
    }
    std::optional<StopCertificate> certificate = make_stop_certificate(paper.loaded);
    std::optional<SpeedAdvisory> advisory = SpeedAdvisory::create(paper.loaded.machine);
    std::optional<MarginAdvisory> margin_advisory = MarginAdvisory::create(paper.loaded.machine);
    ASSERT_TRUE(certificate.has_value() && advisory.has_value() && margin_advisory.has_value());
    struct Way {
        StopCertificate* stop_certificate;
        std::int64_t deadline_us;
    };
    // With and without late cycles, each sampled pose alone and every stop that may still come.
    for (const auto [stop_certificate, deadline_us] :
         {Way{nullptr, 10'000'000}, Way{nullptr, 1}, Way{&*certificate, 10'000'000},
          Way{&*certificate, 1}}) {
        ReplayOptions options;
        options.parts.stop_certificate = stop_certificate;
        options.parts.speed_advisory = &*advisory;
        options.parts.margin_advisory = &*margin_advisory;
        options.deadline_us = deadline_us;
        options.keep_going = true;  // through the stop, and every episode after it
        options.clock.now_ns = &steady_ns;
        std::uint64_t observed = 0;
        ReplayRun run(paper.loaded.machine, paper.engine->engine(), *paper.containment_test,
                      options, [&observed](const ReplayCycle&) { ++observed; });
        const std::uint64_t before = allocations;
        for (const CanFrame& frame : frames) {
            (void)run.on_frame(frame);
        }
        EXPECT_EQ(allocations - before, 0U) << deadline_us;
        EXPECT_EQ(run.frame_count(), frames.size());
        EXPECT_GT(observed, 10'000U);
        EXPECT_GT(run.clearance_levels().slow, 0U) << "levels are asked for as well";
        EXPECT_GE(run.stop_count(), 2U) << "a contact and lost input were on the way";
        EXPECT_GT(run.input().of(ReceiverFault::bad_crc), 0U);
        EXPECT_EQ(run.overruns() > 0, deadline_us == 1);
        EXPECT_EQ(advisory->queries() > 0, stop_certificate != nullptr);
    }
}

// The same where the board sends a look-ahead path and stops along it, frames lost and damaged.
TEST_F(NoAllocation, InAReplayAlongALookAheadPath) {
    test::PaperMachine paper;
    ASSERT_TRUE(paper.engine.has_value());
    Machine& machine = paper.loaded.machine;
    machine.can.format = CanFormat::fd;
    machine.can.look_ahead_samples = 300;
    machine.guard.promise = StopPromise::path_keeping;
    std::vector<CanFrame> frames = test::simulated_frames(machine, test::kDemoProgram);
    for (std::size_t i = 5'000; i < frames.size(); i += 5'000) {
        frames[i].data[5] ^= 1;
    }
    for (std::size_t i = 7'000; i < frames.size(); i += 7'000) {
        frames.erase(frames.begin() + static_cast<std::ptrdiff_t>(i));
    }
    std::optional<StopCertificate> certificate = make_stop_certificate(paper.loaded);
    ASSERT_TRUE(certificate.has_value());
    ReplayOptions options;
    options.parts.stop_certificate = &*certificate;
    options.deadline_us = 10'000'000;
    options.keep_going = true;
    options.clock.now_ns = &steady_ns;
    std::uint64_t permits = 0;
    ReplayRun run(machine, paper.engine->engine(), *paper.containment_test, options,
                  [&permits](const ReplayCycle& cycle) { permits += cycle.result.has_permit; });
    const std::uint64_t before = allocations;
    for (const CanFrame& frame : frames) {
        (void)run.on_frame(frame);
    }
    EXPECT_EQ(allocations - before, 0U);
    EXPECT_GT(permits, 10'000U);
    EXPECT_GE(run.stop_count(), 1U);
    EXPECT_GT(run.input().look_ahead, 10'000U);
    EXPECT_GT(run.input().of(ReceiverFault::bad_crc), 0U);
}

TEST_F(NoAllocation, InAHundredThousandQueriesOfAllKinds) {
    test::Draw draw(test::printed_seed(6));
    const std::vector<Mesh> meshes = test::random_surfaces(draw);
    std::vector<TriangleIds> list(256);
    std::uint64_t kinds[3] = {0, 0, 0}, overflows = 0;
    for (const LaneSet set : test::lane_sets()) {
        for (const Capacities& capacities : {Capacities{}, Capacities{100, 1000, 10}}) {
            CpuEngine engine = *test::engine_over(meshes, capacities, set);
            const std::uint64_t before = allocations;
            for (int i = 0; i < 25'000; ++i) {
                Query query = test::random_query(draw, static_cast<std::uint32_t>(meshes.size()));
                query.list = list;
                ++kinds[static_cast<int>(query.kind)];
                const QueryResult query_result = test::run_query(engine, query);
                overflows += query_result.status != QueryStatus::ok ? 1 : 0;
            }
            EXPECT_EQ(allocations - before, 0U);
        }
    }
    EXPECT_GT(std::min({kinds[0], kinds[1], kinds[2]}), 10'000U);
    EXPECT_GT(overflows, 1'000U);
}

TEST_F(NoAllocation, InQueriesOfContainment) {
    test::Draw draw(test::printed_seed(7));
    test::ContainmentScene scene({{"small", test::ball(6, 3)},
                                  {"ring", test::ring(40, 20, 40, 15)},
                                  {"large", test::ball(20, 50)}});
    std::uint64_t kinds[4] = {0, 0, 0, 0};
    const std::uint64_t before = allocations;
    for (int i = 0; i < 20'000; ++i) {
        Pose pose = test::random_rotation(draw);
        for (double& t : pose.t) {
            t = draw.between(-50, 50);
        }
        const ContainmentResult query_result =
            scene.run(test::ContainmentScene::about(pose, draw.below(3), draw.below(3)));
        ++kinds[static_cast<int>(query_result.containment)];
    }
    EXPECT_EQ(allocations - before, 0U);
    EXPECT_GT(*std::min_element(kinds, kinds + 4), 100U);
}

}  // namespace
}  // namespace axg
