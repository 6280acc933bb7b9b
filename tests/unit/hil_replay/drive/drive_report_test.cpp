// SPDX-License-Identifier: Apache-2.0
// What the brief text of a drive may not leave out, row by row: results made by hand, each with one
// thing that a reader has to see.
#include "hil_replay/drive/drive_report.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <span>
#include <string>

#include "hil_replay/page/run_page.hpp"
#include "tests/support/screen.hpp"

namespace axg::test {
namespace {

/// Two bodies on one axis.
Machine machine_of_one_pair() {
    Machine machine;
    machine.axes = {{.name = "X", .speed_max = 100}};
    machine.bodies.resize(2);
    machine.bodies[0].name = "cutter";
    machine.bodies[1].name = "plate";
    machine.pairs = {{.a = 0, .b = 1}};
    return machine;
}

/// Proves nothing, so every pair counts as touching.
Engine engine_without_proofs() {
    Engine engine;
    engine.run = [](void* /*self*/, std::span<const Query> /*queries*/,
                    std::span<QueryResult> /*results*/) noexcept {};
    return engine;
}

struct Driven {
    Driven() {  // for a second
        result.moving_since_us = 0;
        result.ended_us = 1'000'000;
    }
    [[nodiscard]] DriveReport report() const {
        return {machine, engine_without_proofs(), result, program, mode, 1};
    }
    [[nodiscard]] static std::string text(const DriveReport& report, Detail detail) {
        return printed_text([&](std::FILE* words) { print_drive(report, detail, words); });
    }

    Machine machine = machine_of_one_pair();
    DriveResult result;
    std::string program = "part.ngc", mode = "stoppable";
};

struct Row {
    const char* name;
    std::function<void(Driven&)> prepare;
    std::function<void(DriveReport&)> add;
    std::string shown;
};

void nothing(DriveReport& /*report*/) {}

class DriveNeverHides : public testing::TestWithParam<Row> {};

TEST_P(DriveNeverHides, IsInBothTexts) {
    Driven driven;
    GetParam().prepare(driven);
    DriveReport report = driven.report();
    GetParam().add(report);
    for (const Detail detail : {Detail::brief, Detail::full}) {
        const std::string text = Driven::text(report, detail);
        EXPECT_NE(text.find(GetParam().shown), std::string::npos) << text;
        EXPECT_LE(lines_of(text).size(), kScreenLines);
    }
}

void stopped(Driven& driven) {
    driven.result.state = BoardState::stopped;
}

INSTANTIATE_TEST_SUITE_P(
    Each, DriveNeverHides,
    testing::Values(Row{"NoPermit", [](Driven& d) { d.result.state = BoardState::waiting; },
                        nothing, "STOP: no motion: the guard sent no permit"},
                    Row{"ExpiredPermit", stopped, nothing,
                        "STOP: the last permit expired without renewal"},
                    Row{"OrderedStop",
                        [](Driven& d) {
                            stopped(d);
                            d.result.board_stop.why = BoardStop::guard_said_stop;
                        },
                        nothing, "STOP: the guard ordered a stop"},
                    Row{"InputFault",
                        [](Driven& d) {
                            stopped(d);
                            d.result.guard_stop.cause = GuardFault::input;
                            d.result.guard_stop.reason = StopReason::input;
                            d.result.guard_stop.fault = ReceiverFault::stale;
                        },
                        nothing, "reason of the guard: input, stale: "},
                    Row{"Contact", stopped,
                        [](DriveReport& report) {
                            report.contact.emplace();
                            report.contact->pair = 0;
                            report.contact->time_us = kBoardStartUs;
                        },
                        "CONTACT in motion, 0.0000 s after the start: cutter-plate"},
                    Row{"Held",
                        [](Driven& d) {
                            stopped(d);
                            d.result.is_held = true;
                        },
                        nothing, "HELD: the cap keeps the axes where they stand"},
                    Row{"BrokenCapOfTheBoard",
                        [](Driven& d) {
                            stopped(d);
                            d.result.guard_stop.reason = StopReason::left_cap;
                            d.result.guard_stop.cap = {.kind = CapBreak::too_fast, .axis = 0};
                        },
                        nothing, "the board broke its cap: "},
                    Row{"CapBreaches",
                        [](Driven& d) {
                            stopped(d);
                            d.machine.guard.cap = CapPromise::all_axes;
                            d.result.slow_downs.resize(30);
                            d.result.cap_breaches = 3;
                        },
                        nothing, "the simulated board exceeded its cap 3 times"},
                    Row{"DisobedientDevice",
                        [](Driven& d) {
                            stopped(d);
                            d.machine.guard.obeyed_by = ObeyedBy::line;
                        },
                        nothing, "no line can obey these permits"},
                    Row{"LostInterface", stopped,
                        [](DriveReport& report) {
                            report.bus = BusReport{.interface = "vcan0", .wire = {.is_lost = true}};
                        },
                        "vcan0 went down or was removed"},
                    Row{"OtherBoard", stopped,
                        [](DriveReport& report) {
                            report.bus =
                                BusReport{.interface = "vcan0", .wire = {.other_board_id = 0x181}};
                        },
                        "another board sends on vcan0"},
                    Row{"LatePeriods", stopped,
                        [](DriveReport& report) {
                            report.bus =
                                BusReport{.interface = "vcan0", .wire = {.late_periods = 7}};
                        },
                        "7 of 0 periods late"},
                    Row{"LostFrames",
                        [](Driven& d) {
                            stopped(d);
                            d.result.frames_lost = 12;
                        },
                        nothing, "12 frames lost"}),
    [](const auto& row) { return std::string(row.param.name); });

// Thirty slow-downs are one line in brief; the details list the dearest ten.
TEST(DriveReportText, SlowDownsAreDetails) {
    Driven driven;
    stopped(driven);
    driven.machine.guard.cap = CapPromise::all_axes;
    driven.result.slow_downs.resize(30);
    const DriveReport report = driven.report();
    EXPECT_EQ(Driven::text(report, Detail::brief).find("  at 0.000 s for "), std::string::npos);
    EXPECT_NE(Driven::text(report, Detail::brief).find(": 30 slow-downs, "), std::string::npos);
    EXPECT_NE(Driven::text(report, Detail::full).find("  at 0.000 s for "), std::string::npos);
}

}  // namespace
}  // namespace axg::test
