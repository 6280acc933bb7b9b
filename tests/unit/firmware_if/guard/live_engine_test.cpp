// SPDX-License-Identifier: Apache-2.0
// The engine's side of the live guard's queues: a result leaves before the speed cap of the next
// one is looked for, and that is the next one's.
#include "firmware_if/guard/live_engine.hpp"

#include <gtest/gtest.h>

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
    GuardChain chain(machine, paper.engine->engine(), *paper.containment_test, &*certificate,
                     &*advisory);
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

}  // namespace
}  // namespace axg
