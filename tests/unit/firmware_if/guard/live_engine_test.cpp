// SPDX-License-Identifier: Apache-2.0
// The engine's side of the live guard's queues: an answer leaves before the speed cap of the next
// one is looked for, and that is the next one's.
#include "firmware_if/guard/live_engine.hpp"

#include <gtest/gtest.h>

#include <memory>
#include <optional>
#include <vector>

#include "hil_replay/gcode/gcode_reader.hpp"
#include "tests/support/replay_bench.hpp"

namespace axg {
namespace {

TEST(LiveEngine, APermitWaitsForNoSpeedCap) {
    test::PaperMachine paper;
    const Machine& machine = paper.loaded.machine;
    std::optional<StopPlan> plan = make_stop_plan(paper.loaded);
    std::optional<SpeedHint> hint = SpeedHint::create(machine);
    ASSERT_TRUE(paper.engine && paper.solids && plan && hint);
    GuardChain chain(machine, paper.engine->engine(), *paper.solids, &*plan, &*hint);
    const LiveEngine live{machine, paper.engine->engine(), chain};
    const auto queues = std::make_unique<LiveQueues>();
    LiveQuestion question;
    question.kind = LiveQuestion::Kind::snapshot;
    question.event.kind = ReceiverEvent::Kind::snapshot;
    question.event.state = ReceiverState::valid;
    AxisSnapshot& snapshot = question.event.snapshot;
    snapshot.axis_count = static_cast<std::uint32_t>(machine.axes.size());
    snapshot.position = default_start(machine);
    snapshot.tool = machine.first_tool;
    snapshot.mode = kModeStandstill;
    std::uint8_t found = 0;  // after the answer before
    std::vector<std::uint8_t> caps;
    for (std::uint32_t i = 1; i <= 2 * kSamplesKept; ++i) {
        question.number = i;
        snapshot.sample = i;
        ASSERT_TRUE(queues->questions.push(question));
        answer_questions(live, *queues, [&](const LiveAnswer& answer) {
            EXPECT_EQ(answer.number, i);
            EXPECT_EQ(answer.result.hints.speed_cap, found);
            EXPECT_EQ(hint->cap(), found) << "not looked for before the answer is out";
            caps.push_back(answer.result.hints.speed_cap);
        });
        found = hint->cap();
    }
    ASSERT_EQ(caps.size(), 2 * kSamplesKept);
    EXPECT_EQ(caps[kSamplesKept - 1], 0) << "too little is known yet";
    EXPECT_EQ(caps.back(), kSpeedCapRapid);
}

}  // namespace
}  // namespace axg
