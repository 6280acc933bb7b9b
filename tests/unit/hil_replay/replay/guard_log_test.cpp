// SPDX-License-Identifier: Apache-2.0
// What the guard sends, as a board would read it: in order of time, stops three times a millisecond
// apart, permit pairs that a strict checker accepts, and no permit after the stop.
#include "hil_replay/replay/guard_log.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "firmware_if/protocol/axis_frames.hpp"
#include "tests/support/replay_fixture.hpp"

namespace axg {
namespace {

constexpr std::int64_t kStartUs = 1'000'000;

CycleResult permit() {
    CycleResult result;
    result.has_permit = true;
    result.known_answer_signature = kKnownAnswerSignature;
    return result;
}

CycleResult contact(bool stops_now) {
    CycleResult result;
    result.stops_now = stops_now;
    result.reason = StopReason::contact;
    result.pair = 3;
    result.known_answer_signature = kKnownAnswerSignature;
    return result;
}

CycleResult waiting() {
    CycleResult result;
    result.known_answer_signature = kKnownAnswerSignature;
    return result;
}

class GuardLogTest : public testing::Test {
  protected:
    GuardLog make() { return GuardLog(layout_, shop_.file("out.log")); }
    std::vector<CanFrame> finish(GuardLog& output) {
        EXPECT_TRUE(output.finish()) << output.error();
        return test::read_trace(shop_.file("out.log"));
    }
    [[nodiscard]] std::vector<CanFrame> of(const std::vector<CanFrame>& frames,
                                           std::uint32_t id) const {
        std::vector<CanFrame> out;
        std::copy_if(frames.begin(), frames.end(), std::back_inserter(out),
                     [id](const CanFrame& f) { return f.id == id; });
        return out;
    }
    static void cycle(GuardLog& output, const CycleResult& result, std::uint64_t k,
                      std::int64_t period_us = 1000) {
        output.on_cycle(result, static_cast<std::uint8_t>(k), sync_counter_of(k),
                        kStartUs + static_cast<std::int64_t>(k) * period_us);
    }
    static void expect_in_order(const std::vector<CanFrame>& frames) {
        EXPECT_TRUE(std::is_sorted(
            frames.begin(), frames.end(),
            [](const CanFrame& a, const CanFrame& b) { return a.time_us < b.time_us; }));
    }

    CanLayout layout_;
    test::Workshop shop_;
};

TEST_F(GuardLogTest, PermitsAreGoodPairsUntilTheStopAndNeverAfter) {
    GuardLog output = make();
    for (std::uint64_t k = 0; k < 600; ++k) {  // through both counters' wraps
        cycle(output, k < 2 ? waiting() : k < 500 ? permit() : contact(k == 500), k);
    }
    const std::vector<CanFrame> frames = finish(output);
    expect_in_order(frames);
    PermitChecker checker(layout_);
    std::uint64_t runs = 0, stops = 0;
    bool stopped = false;
    for (const CanFrame& frame : frames) {
        const PermitChecker::Result result = checker.on_frame(frame);
        ASSERT_EQ(result.fault, PermitFault::none) << to_text(result.fault);
        stopped = stopped || decode_stop(layout_, frame) == GuardFrameStatus::ok;
        if (!result.is_permit) {
            continue;
        }
        const std::uint64_t k = static_cast<std::uint64_t>((frame.time_us - kStartUs) / 1000);
        EXPECT_EQ(result.permit.sync_counter, sync_counter_of(k));
        EXPECT_EQ(result.permit.live_counter, static_cast<std::uint8_t>(k));
        EXPECT_EQ(result.permit.known_answer_signature, kKnownAnswerSignature);
        EXPECT_EQ(result.permit.word, k >= 2 && k < 500 ? PermitWord::run : PermitWord::stop);
        EXPECT_EQ(result.permit.speed_cap,
                  result.permit.word == PermitWord::run ? kSpeedCapRapid : 0);
        EXPECT_FALSE(stopped && result.permit.word != PermitWord::stop);
        ++(result.permit.word == PermitWord::run ? runs : stops);
    }
    EXPECT_EQ(runs, 498U);
    EXPECT_EQ(stops, 102U);
}

TEST_F(GuardLogTest, TheTwinIsEveryBitTurned) {
    GuardLog output = make();
    cycle(output, permit(), 7);
    const std::vector<CanFrame> frames = finish(output);
    const auto plain = of(frames, layout_.permit_id), twin = of(frames, layout_.permit_id + 1);
    ASSERT_EQ(plain.size(), 1U);
    ASSERT_EQ(twin.size(), 1U);
    for (std::size_t i = 0; i < 8; ++i) {
        EXPECT_EQ(plain[0].data[i] ^ twin[0].data[i], 0xFF);
    }
}

TEST_F(GuardLogTest, AStopIsSentFirstAndThreeTimesAMillisecondApartAtAnyCycleTime) {
    for (const std::int64_t period_us : {100, 1000, 4000}) {
        GuardLog output = make();
        for (std::uint64_t k = 0; k < 60; ++k) {
            cycle(output, k < 20 ? permit() : contact(k == 20), k, period_us);
        }
        const std::vector<CanFrame> frames = finish(output);
        expect_in_order(frames);
        const auto stops = of(frames, layout_.stop_id);
        ASSERT_EQ(stops.size(), kStopRepeats);
        const std::int64_t stop_us = kStartUs + 20 * period_us;
        for (std::size_t i = 0; i < stops.size(); ++i) {
            EXPECT_EQ(stops[i].time_us, stop_us + static_cast<std::int64_t>(i) * 1000);
            EXPECT_EQ(stops[i].length_bytes, 0);
        }
        for (const CanFrame& stop : stops) {
            const auto first =
                std::find_if(frames.begin(), frames.end(),
                             [&stop](const CanFrame& f) { return f.time_us == stop.time_us; });
            EXPECT_EQ(first->id, layout_.stop_id) << "before the permit of the same instant";
        }
        const auto emergencies = of(frames, layout_.emergency_id);
        ASSERT_EQ(emergencies.size(), 1U);
        Emergency emergency;
        EXPECT_EQ(decode_emergency(layout_, emergencies[0], emergency), GuardFrameStatus::ok);
        EXPECT_EQ(emergency.code, EmergencyCode::contact);
        EXPECT_EQ(emergency.pair, 3);
    }
}

TEST_F(GuardLogTest, EachDriveIsToldToStopAfterEachStop) {
    layout_.quick_stop_ids = {0x303, 0x304};
    GuardLog output = make();
    cycle(output, permit(), 0);
    cycle(output, contact(true), 1);
    const std::vector<CanFrame> frames = finish(output);
    expect_in_order(frames);
    std::vector<std::uint32_t> ids;
    for (const CanFrame& frame : frames) {
        if (frame.id == layout_.stop_id || frame.id == 0x303 || frame.id == 0x304) {
            ids.push_back(frame.id);
        }
    }
    EXPECT_EQ(ids, (std::vector<std::uint32_t>{1, 0x303, 0x304, 1, 0x303, 0x304, 1, 0x303, 0x304}));
    for (const CanFrame& frame : of(frames, 0x304)) {
        ASSERT_EQ(frame.length_bytes, 2);
        EXPECT_EQ(frame.data[0], 0x02) << "quick stop: bit 1 set, bit 2 clear";
        EXPECT_EQ(frame.data[1], 0);
    }
}

TEST_F(GuardLogTest, TheRepeatsComeEvenWhenTheTraceEndsAtTheStop) {
    GuardLog output = make();
    cycle(output, permit(), 0);
    cycle(output, contact(true), 1);
    EXPECT_EQ(of(finish(output), layout_.stop_id).size(), kStopRepeats);
}

TEST_F(GuardLogTest, LostInputSendsStopsAndNoPermit) {
    GuardLog output = make();
    cycle(output, permit(), 0);
    output.on_input_lost(kStartUs + 4000);
    const std::vector<CanFrame> frames = finish(output);
    expect_in_order(frames);
    EXPECT_EQ(of(frames, layout_.stop_id).size(), kStopRepeats);
    EXPECT_EQ(of(frames, layout_.permit_id).size(), 1U);
    Emergency emergency;
    ASSERT_EQ(decode_emergency(layout_, of(frames, layout_.emergency_id).at(0), emergency),
              GuardFrameStatus::ok);
    EXPECT_EQ(emergency.code, EmergencyCode::input_stale);
    EXPECT_EQ(emergency.pair, 255) << "none";
}

TEST_F(GuardLogTest, EveryReasonHasItsEmergencyCode) {
    const std::pair<StopReason, EmergencyCode> codes[] = {
        {StopReason::contact, EmergencyCode::contact},
        {StopReason::contained, EmergencyCode::contact},
        {StopReason::capacity, EmergencyCode::contact},
        {StopReason::engine, EmergencyCode::contact},
        {StopReason::known_answer, EmergencyCode::known_answer},
        {StopReason::tool, EmergencyCode::model_hash},
        {StopReason::snapshot, EmergencyCode::input_stale},
        {StopReason::input, EmergencyCode::input_stale}};
    for (const auto& [reason, code] : codes) {
        GuardLog output = make();
        CycleResult result = contact(true);
        result.reason = reason;
        cycle(output, result, 1);
        Emergency emergency;
        ASSERT_EQ(
            decode_emergency(layout_, of(finish(output), layout_.emergency_id).at(0), emergency),
            GuardFrameStatus::ok);
        EXPECT_EQ(emergency.code, code) << to_text(reason);
    }
}

TEST_F(GuardLogTest, TheHeartbeatSaysStartingThenRunningThenTripped) {
    GuardLog output = make();
    for (std::uint64_t k = 0; k < 100; ++k) {
        cycle(output, k < 15 ? waiting() : k < 45 ? permit() : contact(k == 45), k);
    }
    std::vector<GuardHeartbeat> heartbeats;
    std::int64_t last_us = 0;
    for (const CanFrame& frame : of(finish(output), layout_.heartbeat_out_id)) {
        GuardHeartbeat heartbeat{};
        ASSERT_EQ(decode_guard_heartbeat(layout_, frame, heartbeat), GuardFrameStatus::ok);
        EXPECT_TRUE(heartbeats.empty() || frame.time_us - last_us == 10'000);
        last_us = frame.time_us;
        heartbeats.push_back(heartbeat);
    }
    using enum GuardHeartbeat;
    EXPECT_EQ(heartbeats,
              (std::vector<GuardHeartbeat>{starting, starting, running, running, running, tripped,
                                           tripped, tripped, tripped, tripped}));
}

TEST_F(GuardLogTest, AFileThatCannotBeWrittenIsSaid) {
    GuardLog output(layout_, shop_.file("no/such/folder/out.log"));
    cycle(output, permit(), 0);
    EXPECT_FALSE(output.finish());
    EXPECT_NE(output.error().find("no/such/folder/out.log"), std::string::npos) << output.error();
}

}  // namespace
}  // namespace axg
