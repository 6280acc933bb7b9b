// SPDX-License-Identifier: Apache-2.0
// The period is read from SYNC frames alone, and jitter and losses do not move it.
#include "hil_replay/trace/trace_period.hpp"

#include <gtest/gtest.h>

#include "hil_replay/trace/added_session.hpp"
#include "hil_replay/trace/candump_log.hpp"
#include "tests/support/can_board.hpp"
#include "tests/support/session_frame.hpp"

namespace axg {
namespace {

std::uint32_t period_of(const std::string& text) {
    const auto reader = read_candump("t.log", text, {});
    const std::uint32_t period = trace_period_us(*reader, 0x080);
    EXPECT_EQ(reader->error(), "");
    return period;
}

TEST(TracePeriod, IsThatOfTheBoard) {
    for (const std::uint32_t sample_us : {100U, 500U, 1000U, 2000U}) {
        Machine machine = test::five_axis_machine(CanFormat::classical);
        machine.can.sample_us = sample_us;
        std::string text;
        std::uint64_t k = 0;
        for (const auto& sample : test::board_frames(machine, 200)) {
            for (CanFrame frame : sample) {
                if (frame.id == 0x080 && k % 10 == 5) {
                    continue;  // a lost SYNC now and then
                }
                frame.time_us += frame.id == 0x080 ? 0 : 1;
                append_candump(text, frame, "can0");
            }
            ++k;
        }
        EXPECT_EQ(period_of(text), sample_us);
    }
}

// A gateway or a second master that sends each SYNC again: the counter tells.
TEST(TracePeriod, IsNotThatOfDoubledSyncs) {
    Machine machine = test::five_axis_machine(CanFormat::classical);
    std::string text;
    for (const auto& sample : test::board_frames(machine, 100)) {
        for (CanFrame frame : sample) {
            append_candump(text, frame, "can0");
            if (frame.id == 0x080) {
                frame.time_us += 90;
                append_candump(text, frame, "can0");
            } else {
                frame.time_us += 100;
            }
        }
    }
    const auto reader = read_candump("t.log", text, {.backwards_us_max = 1000});
    EXPECT_EQ(trace_period_us(*reader, 0x080), machine.can.sample_us);
}

// A replay takes the trace's period; a live guard with the same machine file would refuse it.
TEST(TracePeriod, IsJudgedAsALiveGuardWould) {
    struct Case {
        std::int64_t board_us;
        PeriodVerdict verdict;
    };
    for (const Case& one : {Case{1000, PeriodVerdict::right}, Case{995, PeriodVerdict::right},
                            Case{950, PeriodVerdict::wrong}, Case{1020, PeriodVerdict::wrong}}) {
        const Machine machine = test::five_axis_machine(CanFormat::classical);
        std::string text;
        std::int64_t k = 0;
        for (const auto& sample : test::board_frames(machine, 1000)) {
            for (CanFrame frame : sample) {
                frame.time_us += (one.board_us - 1000) * k;
                append_candump(text, frame, "can0");
                if (frame.id == 0x080) {
                    append_candump(text, frame, "can0");  // sent twice: one period
                }
            }
            ++k;
        }
        const auto reader = read_candump("t.log", text, {});
        const TracePeriod period = judge_trace_period(*reader, machine);
        EXPECT_EQ(reader->error(), "");
        EXPECT_EQ(period.verdict, one.verdict) << one.board_us;
        EXPECT_EQ(period.declared_us, 1000U);
        EXPECT_NEAR(static_cast<double>(period.measured_ns),
                    1000.0 * static_cast<double>(one.board_us), 100);
    }
}

TEST(TracePeriod, IsUnknownWithFewerThanThreeSyncs) {
    EXPECT_EQ(period_of(""), 0U);
    EXPECT_EQ(period_of("(1.000000) can0 080#01\n(1.001000) can0 080#02\n"), 0U);
    EXPECT_EQ(period_of("(1.000000) can0 080#01\n(1.001000) can0 080#02\n(1.002000) can0 080#03\n"),
              1000U);
    EXPECT_EQ(period_of("(1.000000) can0 00000080#01\n(1.001000) can0 00000080#02\n"
                        "(1.002000) can0 00000080#03\n"),
              0U);
}

// A session frame that is right, within the first second: the board says it ten times a second.
TEST(TraceSession, IsFoundInTheFirstSecond) {
    const auto has = [](std::int64_t time_us, bool is_damaged) {
        std::string text;
        append_candump(text, encode_sync(0x080, 1, 5'000'000), "can0");
        CanFrame session = test::session_frame({.number = 7}, time_us);
        session.data[7] ^= is_damaged ? 1U : 0U;
        append_candump(text, session, "can0");
        const auto reader = read_candump("t.log", text, {});
        return has_session_frames(*reader, 0x583);
    };
    EXPECT_TRUE(has(5'000'100, false));
    EXPECT_TRUE(has(6'000'000, false));
    EXPECT_FALSE(has(6'000'001, false));
    EXPECT_FALSE(has(5'000'100, true));
    const auto empty = read_candump("t.log", "", {});
    EXPECT_FALSE(has_session_frames(*empty, 0x583));
}

// Over more than two laps, with lost SYNCs, the added session is one that a receiver believes.
TEST(TraceSession, IsAddedAsABoardWouldSendIt) {
    const Machine machine = test::five_axis_machine(CanFormat::classical);
    AxisEncoder encoder(machine, {.says_session = false});
    std::string text;
    for (std::uint64_t k = 0; k < 600; ++k) {
        for (const CanFrame& frame : test::frames_of(encoder, test::snapshot_at(machine, k))) {
            if (frame.id != machine.can.sync_id || k % 7 != 6) {
                append_candump(text, frame, "can0");
            }
        }
    }
    const auto trace = with_session(read_candump("t.log", text, {}), machine.can);
    AxisReceiver receiver(machine);
    std::uint64_t sessions = 0, samples = 0;
    CanFrame frame;
    while (trace->next(frame)) {
        sessions += frame.id == machine.can.session_in_id ? 1U : 0U;
        const ReceiverEvent event = receiver.on_frame(frame);
        EXPECT_NE(event.fault, ReceiverFault::held_up);
        if (event.kind != ReceiverEvent::Kind::snapshot) {
            continue;
        }
        ++samples;
        const auto session = receiver.session_of(event.sync_counter);
        ASSERT_EQ(session.has_value(), samples > 1) << event.snapshot.sample;
        EXPECT_EQ(session ? session->lap : 0, event.snapshot.sample / kSyncCounterMax);
    }
    EXPECT_GT(samples, 500U);
    EXPECT_EQ(sessions, 7U) << "at once twice, then every 100 ms";
}

}  // namespace
}  // namespace axg
