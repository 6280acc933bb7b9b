// SPDX-License-Identifier: Apache-2.0
// The period is read from SYNC frames alone, and jitter and losses do not move it.
#include "hil_replay/trace/trace_period.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <string>
#include <vector>

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

// A session frame that is right, wherever it comes: the board may be switched on late.
TEST(TraceSession, IsFoundWhereverItBegins) {
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
    EXPECT_TRUE(has(60'000'000, false));
    EXPECT_FALSE(has(5'000'100, true));
    const auto empty = read_candump("t.log", "", {});
    EXPECT_FALSE(has_session_frames(*empty, 0x583));
}

/// Samples of a board that sends no session, changed by `damage`, with the added session.
struct AddedSessions {
    std::uint64_t samples = 0, without = 0, held_up = 0;
};
AddedSessions add_sessions(
    const std::function<void(std::uint64_t, std::vector<CanFrame>&)>& damage) {
    const Machine machine = test::five_axis_machine(CanFormat::classical);
    AxisEncoder encoder(machine, {.says_session = false});
    AddedSession added(machine.can);
    AxisReceiver receiver(machine);
    AddedSessions out;
    const auto hear = [&](const CanFrame& frame) {
        const ReceiverEvent event = receiver.on_frame(frame);
        out.held_up += event.fault == ReceiverFault::held_up ? 1U : 0U;
        if (event.kind == ReceiverEvent::Kind::snapshot) {
            ++out.samples;
            out.without += receiver.session_of(event.sync_counter) ? 0U : 1U;
        }
    };
    for (std::uint64_t k = 0; k < 600; ++k) {
        std::vector<CanFrame> frames = test::frames_of(encoder, test::snapshot_at(machine, k));
        damage(k, frames);
        for (const CanFrame& frame : frames) {
            hear(frame);
            if (const auto session = added.behind(frame)) {
                hear(*session);
            }
        }
    }
    return out;
}

// Over more than two laps; only the first sample has none, for a receiver numbers samples first.
TEST(TraceSession, IsAddedAsABoardWouldSendIt) {
    const AddedSessions whole = add_sessions([](std::uint64_t, std::vector<CanFrame>&) {});
    EXPECT_EQ(whole.samples, 600U);
    EXPECT_EQ(whole.without, 1U);
    EXPECT_EQ(whole.held_up, 0U);
    const AddedSessions lost = add_sessions([](std::uint64_t k, std::vector<CanFrame>& frames) {
        if (k % 7 == 6) {
            frames.erase(frames.begin());
        }
    });
    EXPECT_GT(lost.samples, 500U);
    EXPECT_EQ(lost.without, 1U);
    EXPECT_EQ(lost.held_up, 0U);
}

// A damaged, foreign or doubled SYNC, and a head that no sample is complete in: no false fault.
TEST(TraceSession, ABadSyncMakesItNoOlder) {
    for (const unsigned bad : {0x00U, 0x11U, 0xEEU, 0xF1U, 0xFFU}) {
        const AddedSessions out =
            add_sessions([bad](std::uint64_t k, std::vector<CanFrame>& frames) {
                if (k == 0 || k == 60 || k == 450) {
                    frames[0].data[0] = static_cast<std::uint8_t>(bad);
                }
            });
        EXPECT_GT(out.samples, 500U);
        EXPECT_EQ(out.held_up, 0U) << bad;
        EXPECT_LE(out.without, 2U) << bad;
    }
    const AddedSessions twice = add_sessions([](std::uint64_t k, std::vector<CanFrame>& frames) {
        if (k == 0) {
            frames.insert(frames.begin(), frames[0]);
        }
    });
    EXPECT_EQ(twice.held_up, 0U);
    EXPECT_LE(twice.without, 2U);
}

}  // namespace
}  // namespace axg
