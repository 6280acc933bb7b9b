// SPDX-License-Identifier: Apache-2.0
// Recorded buses to watch: what is missing in them is named, with the next step, and two traces of
// one time are played as one bus.
#include "hil_replay/watch/watched_trace.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "firmware_if/guard/live_ids.hpp"
#include "hil_replay/trace/candump_log.hpp"
#include "hil_replay/watch/watch_state.hpp"
#include "hil_replay/watch/watched_bus.hpp"
#include "tests/support/replay_fixture.hpp"
#include "tests/support/watched_frames.hpp"

namespace axg {
namespace {

class WatchedTrace : public testing::Test {
  protected:
    void SetUp() override {
        for (CanFrame& frame : frames) {  // a guard answers after the sample's last frame
            frame.time_us += is_guard_id(machine.can, frame.id) ? 200 : 0;
        }
        std::stable_sort(frames.begin(), frames.end(),
                         [](const auto& a, const auto& b) { return a.time_us < b.time_us; });
    }
    enum class Of : std::uint8_t { board, guard, both };

    /// The bus of watched_frames(), as candump on this side of it would have written it.
    std::string record(const std::string& name, Of side, std::int64_t later_us = 0) {
        CandumpWriter out(shop.file(name));
        for (CanFrame frame : frames) {
            const bool is_of_guard = is_guard_id(machine.can, frame.id);
            frame.time_us += later_us;
            if (side == Of::both || is_of_guard == (side == Of::guard)) {
                out.write(frame);
            }
        }
        EXPECT_TRUE(out.finish()) << out.error();
        return shop.file(name);
    }
    std::vector<TraceContent> contents(const std::vector<std::string>& paths) {
        std::vector<TraceContent> out;
        for (const std::string& path : paths) {
            std::string fault;
            const auto content = read_content(machine, path, fault);
            EXPECT_TRUE(content) << fault;
            out.push_back(content.value_or(TraceContent{}));
        }
        return out;
    }

    test::Workshop shop;
    Machine machine = test::watched_machine();
    std::vector<CanFrame> frames = test::watched_frames(machine, 40);
};

TEST_F(WatchedTrace, EachSideIsCounted) {
    const auto sides = contents({record("board.log", Of::board), record("guard.log", Of::guard)});
    EXPECT_EQ(sides[0].of_board, 3U * 40U);
    EXPECT_EQ(sides[0].of_guard, 0U);
    EXPECT_EQ(sides[1].of_board, 0U);
    EXPECT_EQ(sides[1].of_guard, 2U * 40U + 2U * 4U);
    EXPECT_EQ(sides[0].frames + sides[1].frames, frames.size());
    EXPECT_EQ(sides[0].first_us, frames.front().time_us);
}

TEST_F(WatchedTrace, WhatIsMissingIsNamedWithTheNextStep) {
    const std::string board = record("board.log", Of::board);
    const std::string guard = record("guard.log", Of::guard);
    const auto notes = [&](const std::vector<std::string>& paths) {
        const auto found = contents(paths);
        EXPECT_EQ(fault_of_traces(found), "");
        return notes_about(found, machine, "m.yaml");
    };
    ASSERT_EQ(notes({board}).size(), 1U);
    EXPECT_EQ(notes({board})[0],
              board +
                  ": no frame of the guard, such as its permit 0x103. Record with the guard on the "
                  "bus. To see what it would have sent: axguard replay m.yaml " +
                  board + " --frames-out guard.log, then add --trace guard.log.");
    ASSERT_EQ(notes({guard}).size(), 1U);
    EXPECT_EQ(notes({guard})[0], guard +
                                     ": no position of the board. Add the board's trace of the "
                                     "same time by a second --trace.");
    EXPECT_TRUE(notes({board, guard}).empty());
    EXPECT_TRUE(notes({record("both.log", Of::both)}).empty());
    (void)shop.write("two.log", test::content_of(board) + "(99.000000) can1 123#00\nrubbish\n");
    ASSERT_EQ(notes({shop.file("two.log"), guard}).size(), 1U);
    EXPECT_EQ(notes({shop.file("two.log"), guard})[0].find("2 lines left out; the first: "), 0U);
}

TEST_F(WatchedTrace, TracesThatShowNothingTogetherAreRefused) {
    (void)shop.write("other.log", "(1.000000) can0 7A5#0011\n(2.000000) can0 7A5#0012\n");
    EXPECT_EQ(fault_of_traces(contents({shop.file("other.log")})),
              shop.file("other.log") +
                  ": no frame of the board or the guard (found 2 frames, expected the identifiers "
                  "of the machine file). Compare them: axguard inspect " +
                  shop.file("other.log"));
    const std::string board = record("board.log", Of::board);
    const std::int64_t length_us = frames.back().time_us - frames.front().time_us;
    EXPECT_EQ(fault_of_traces(contents({board, record("a.log", Of::guard, length_us - 1000)})), "");
    const std::string later = record("b.log", Of::guard, 100'000'000);
    for (const auto& order : {std::vector{board, later}, std::vector{later, board}}) {
        EXPECT_EQ(fault_of_traces(contents(order)).find(board + ": no time in common with"), 0U)
            << fault_of_traces(contents(order));
    }
    std::string fault;
    EXPECT_FALSE(read_content(machine, shop.write("empty.log", ""), fault));
    EXPECT_EQ(fault, shop.file("empty.log") + ": the trace is empty");
}

TEST_F(WatchedTrace, TwoTracesArePlayedAsOneBus) {
    std::string fault;
    const auto bus = WatchedBus::open_traces(
        {record("board.log", Of::board), record("guard.log", Of::guard)}, fault);
    ASSERT_TRUE(bus) << fault;
    BusView view(machine, {});
    std::vector<CanFrame> played;
    for (int turn = 0; turn < 1000 && !bus->end_us(); ++turn) {
        bus->read_until(0, [&](const CanFrame& frame) {
            played.push_back(frame);
            view.on_frame(frame);
        });
    }
    ASSERT_EQ(played.size(), frames.size());
    EXPECT_TRUE(std::is_sorted(played.begin(), played.end(),
                               [](const auto& a, const auto& b) { return a.time_us < b.time_us; }));
    EXPECT_EQ(bus->end_us(), played.back().time_us);
    EXPECT_EQ(bus->fault(), bus->name() + ": the trace has ended");
    EXPECT_TRUE(view.state().axes);
    EXPECT_EQ(view.state().answer, PermitAnswer::right) << "of the board's session";
    EXPECT_EQ(view.state().bad, 0U);
}

TEST_F(WatchedTrace, ATraceIsNoGuardThatCannotBeReached) {
    WatchedTraces traces{.has_guard = false, .notes = {"board.log: no frame of the guard"}};
    WatchInput input{.machine = machine, .configuration = ""};
    input.traces = &traces;
    EXPECT_EQ(headline_of(input).text, "No guard in this trace");
    EXPECT_EQ(notes_of(input), traces.notes);
    traces.has_guard = true;
    EXPECT_EQ(headline_of(input).text, "No frame of the guard");
    BusView view(machine, {});
    for (const CanFrame& frame : frames) {
        view.on_frame(frame);
    }
    input.bus = &view.state();
    input.now_us = frames.back().time_us;
    EXPECT_EQ(headline_of(input).text, "Armed");
    traces.is_over = true;
    EXPECT_EQ(headline_of(input).text, "End of the trace: Armed") << "what came last stays";
}

}  // namespace
}  // namespace axg
