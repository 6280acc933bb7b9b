// SPDX-License-Identifier: Apache-2.0
// From status line and bus to the words and the JSON of the live page.
#include "hil_replay/watch/watch_state.hpp"

#include <gtest/gtest.h>

#include "firmware_if/live/status_line.hpp"
#include "tests/support/json_value.hpp"
#include "tests/support/watched_frames.hpp"

namespace axg {
namespace {

const std::string kHash(64, 'a');

class WatchState : public testing::Test {
  protected:
    /// As the guard writes it.
    [[nodiscard]] GuardLine line_of(const LiveView& live, const std::string& hash = kHash) const {
        const StatusLine status(machine, "m.yaml", "can0", "stoppable", hash);
        std::array<char, kStatusLineBytesMax> text{};
        const std::size_t size = status.write(&live, why, live.time_us, text);
        const auto line = read_guard_line({text.data(), size});
        EXPECT_TRUE(line);
        return line.value_or(GuardLine{});
    }
    void hear(std::uint64_t samples) {
        for (const CanFrame& frame : test::watched_frames(machine, samples)) {
            view.on_frame(frame);
        }
        input.bus = &view.state();
        input.bus_name = "can0";
        input.now_us = test::snapshot_at(machine, samples - 1).latched_us + 1000;
    }
    void set_line(const LiveView& live, const std::string& hash = kHash) {
        input.reads_status = true;
        input.status = line_of(live, hash);
        input.status_us = input.now_us;
    }
    [[nodiscard]] test::Json json() const { return test::Json::parse(watch_json(input)); }
    [[nodiscard]] bool notes(const std::string& words) const {
        for (const std::string& note : notes_of(input)) {
            if (note.find(words) != std::string::npos) {
                return true;
            }
        }
        return false;
    }

    Machine machine = test::watched_machine();
    StatusWhy why;
    BusView view{machine, {}};
    WatchInput input{.machine = machine, .configuration = kHash};
};

TEST_F(WatchState, NothingHeardIsNotReachable) {
    input.reads_status = true;
    input.status_fault = "/run/axguardd/can0/status: no guard. Start axguardd run.";
    EXPECT_EQ(headline_of(input).kind, "unreachable");
    EXPECT_EQ(headline_of(input).text, "Guard not reachable");
    EXPECT_TRUE(notes("no guard"));
    EXPECT_TRUE(json()["guard"].is_null());
    EXPECT_TRUE(json()["axes"].is_null());
}

TEST_F(WatchState, TheStatusLineDecidesThePhase) {
    LiveView live;
    live.phase = GuardPhase::ready;
    live.withheld = {
        .why = WithheldPermit::Why::not_proven, .reason = StopReason::predicted, .pair = 1};
    set_line(live);
    EXPECT_EQ(headline_of(input).kind, "ready");
    EXPECT_EQ(json()["guard"]["withheld"], "not proven: predicted: head - plate");
    EXPECT_EQ(json()["guard"]["same_machine"], true);
    live.phase = GuardPhase::armed;
    set_line(live);
    EXPECT_EQ(headline_of(input).kind, "armed");
}

TEST_F(WatchState, AStopHasCauseReasonAndPair) {
    LiveView live;
    live.phase = GuardPhase::stopped;
    live.cause = GuardFault::verdict;
    live.reason = StopReason::contact;
    live.pair = 0;
    live.phase_us = 0;
    live.time_us = 4'000'000;
    set_line(live);
    EXPECT_EQ(headline_of(input).kind, "stopped");
    EXPECT_EQ(headline_of(input).text, "STOP: verdict: contact: cutter - plate");
    EXPECT_EQ(headline_of(input).since_ms, 4000);
}

TEST_F(WatchState, DistancesOfAStopAndOfAWithheldPermitArePassedOn) {
    LiveView live;
    live.phase = GuardPhase::armed;
    live.withheld = {.why = WithheldPermit::Why::nothing};
    set_line(live);
    EXPECT_TRUE(json()["why"].empty());
    live.withheld = {
        .why = WithheldPermit::Why::not_proven, .reason = StopReason::predicted, .pair = 1};
    set_line(live);
    auto said = json()["why"];
    ASSERT_EQ(said.size(), 1U);
    EXPECT_EQ(said[0]["of"], "permit withheld");
    EXPECT_EQ(said[0]["pair"], "head - plate");
    EXPECT_TRUE(said[0]["distances"].is_null());
    EXPECT_EQ(said[0]["words"], "not known");
    live.phase = GuardPhase::stopped;
    live.cause = GuardFault::verdict;
    live.reason = StopReason::predicted;
    live.pair = 0;
    why.stop.why = PairWhy{};
    why.stop.why->distances.need = {.margin_mm = 2, .braking_mm = 3.5};
    why.stop.why->distances.within_mm = 50;
    why.stop.why->distances.available_mm = 4.25;
    set_line(live);
    said = json()["why"];
    ASSERT_EQ(said.size(), 2U);
    EXPECT_EQ(said[0]["of"], "stop");
    EXPECT_EQ(said[0]["pair"], "cutter - plate");
    EXPECT_EQ(said[0]["distances"]["needed_mm"], 5.5);
    EXPECT_EQ(said[0]["distances"]["available_mm"], 4.25);
    EXPECT_EQ(said[0]["distances"]["braking_mm"], 3.5);
    EXPECT_EQ(said[0]["words"], "");
    EXPECT_EQ(said[1]["of"], "permit withheld");
}

TEST_F(WatchState, AStopHasItsWayOutAndItsProgramLine) {
    LiveView live;
    live.phase = GuardPhase::stopped;
    live.cause = GuardFault::verdict;
    live.reason = StopReason::predicted;
    live.pair = 0;
    live.program_line = 7;
    set_line(live);
    EXPECT_TRUE(json()["why"][0]["ways_out"].empty()) << "none is known";
    why.stop.account.ways_out = "jog Z+ (1 mm: clearance at least 1.3000 mm) or X-";
    set_line(live);
    EXPECT_EQ(json()["why"][0]["ways_out"][0], why.stop.account.ways_out);
    EXPECT_EQ(headline_of(input).text, "STOP: verdict: predicted: cutter - plate, program line 7");
    live.reason = StopReason::tool;
    live.pair = kNoIndex;
    why.stop.account = {};
    why.stop.account.unknown_tool = std::uint16_t{3};
    set_line(live);
    const auto said = json()["why"];
    ASSERT_EQ(said.size(), 1U);
    EXPECT_EQ(said[0]["ways_out"][0],
              "tool 3 is not in m.yaml: add it under tools; load another tool to go on");
}

TEST_F(WatchState, AnotherMachineFileIsSaid) {
    LiveView live;
    live.phase = GuardPhase::armed;
    set_line(live, std::string(64, 'b'));
    EXPECT_TRUE(notes("Another machine file"));
    EXPECT_EQ(json()["guard"]["same_machine"], false);
}

TEST_F(WatchState, AGuardThatWasReachedIsNotAnyMore) {
    LiveView live;
    live.phase = GuardPhase::armed;
    set_line(live);
    input.now_us += 4'000'000;
    EXPECT_EQ(headline_of(input).kind, "unreachable");
    EXPECT_EQ(headline_of(input).since_ms, 4000);
    input.now_us -= 4'000'000;
    input.status_fault = "no reply";
    EXPECT_EQ(headline_of(input).kind, "unreachable");
}

TEST_F(WatchState, TheBusAloneShowsAnArmedGuard) {
    hear(300);
    EXPECT_EQ(headline_of(input).kind, "armed");
    const auto said = json();
    EXPECT_TRUE(said["why"].empty()) << "nothing is withheld";
    EXPECT_EQ(said["permit"]["word"], "slow");
    EXPECT_EQ(said["permit"]["in_force"], true);
    EXPECT_EQ(said["permit"]["samples"], 3);
    EXPECT_EQ(said["permit"]["cap_percent"], 50.0);
    EXPECT_EQ(said["permit"]["level"], "slow");
    EXPECT_EQ(said["hints"]["name"], "head - plate");
    EXPECT_EQ(said["hints"]["distance_mm"], 1.31);
    EXPECT_EQ(said["axes"]["positions"].size(), 5U);
    EXPECT_EQ(said["axes"]["mode"], "moving");
    input.now_us += 3000;
    EXPECT_EQ(json()["permit"]["in_force"], false);
    EXPECT_EQ(json()["why"].size(), headline_of(input).kind == "armed" ? 1U : 0U);
}

TEST_F(WatchState, ASilentGuardIsNotReachableAndItsPermitNotInForce) {
    hear(300);
    input.now_us += 2'000'000;
    EXPECT_EQ(headline_of(input).kind, "unreachable");
    EXPECT_EQ(json()["permit"]["in_force"], false);
    LiveView live;
    live.phase = GuardPhase::armed;
    set_line(live);
    EXPECT_TRUE(notes("No frame of the guard on can0 for 2.0 s"));
}

TEST_F(WatchState, TheBusAloneShowsAStop) {
    hear(300);
    view.on_frame(encode_emergency(
        machine.can, {.code = EmergencyCode::predicted_collision, .error_register = 1, .pair = 0},
        input.now_us));
    view.on_frame(encode_guard_heartbeat(machine.can, GuardHeartbeat::tripped, input.now_us));
    EXPECT_EQ(headline_of(input).kind, "stopped");
    EXPECT_EQ(headline_of(input).text, "STOP: predicted_collision: cutter - plate");
    const auto said = json()["why"];
    ASSERT_EQ(said.size(), 1U);
    EXPECT_EQ(said[0]["pair"], "cutter - plate");
    EXPECT_TRUE(said[0]["distances"].is_null());
    EXPECT_EQ(said[0]["words"], "not known: the status socket is not read");
}

TEST_F(WatchState, ALineOfAnotherVersionOrOfGarbageIsNone) {
    EXPECT_FALSE(read_guard_line(""));
    EXPECT_FALSE(read_guard_line("{}"));
    EXPECT_FALSE(read_guard_line(std::string(5000, '{')));
    EXPECT_FALSE(read_guard_line("{\"axguardd\":\"9\",\"phase\":\"armed\"}"));
    const auto init =
        read_guard_line(R"({"axguardd":"0","bus":"can0","machine":"m","file":"m.yaml",)"
                        R"("configuration_sha256":"","mode":"x",)"
                        R"("board_test":{"record":"none","serial":null,"date":null,"differs":[]},)"
                        R"("phase":"init"})");
    ASSERT_TRUE(init);
    input.status = init;
    input.status_us = 0;
    input.now_us = 0;
    EXPECT_EQ(headline_of(input).kind, "init");
}

TEST_F(WatchState, ForeignTextStaysTextInTheJson) {
    LiveView live;
    live.phase = GuardPhase::armed;
    set_line(live);
    input.status->machine = "<script>\x1b[2J\xff";
    const auto said = json();  // parses: one line of ASCII
    EXPECT_NE(said["guard"]["machine"].get<std::string>().find("<script>"), std::string::npos);
    EXPECT_EQ(watch_json(input).find('\n'), std::string::npos);
}

}  // namespace
}  // namespace axg
