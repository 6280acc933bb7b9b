// SPDX-License-Identifier: Apache-2.0
// Samples without SYNC and counter, numbered by their arrival: late ones count once, lost ones
// count, and more jitter than the speeds are bounded for stops.
#include "firmware_if/receiver/arrival_anchor.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "core/certificate/stop_certificate.hpp"
#include "core/reach/motion_history.hpp"
#include "tests/support/receiver_fixture.hpp"

namespace axg {
namespace {

using namespace test;

ArrivalAnchor anchor_of(std::int64_t jitter_us) {
    return {.period_us = 1000, .jitter_us = jitter_us};
}

TEST(ArrivalAnchor, LateArrivalsCountOnce) {
    for (const std::int64_t late_us : {0, 300, 600, 990}) {
        ArrivalAnchor anchor = anchor_of(1000);
        for (std::int64_t k = 0; k < 1000; ++k) {
            const ArrivalNumber number =
                number_arrival(anchor, 5000 + 1000 * k + (k % 2) * late_us);
            EXPECT_EQ(number.steps, 1U) << k;
            EXPECT_TRUE(number.is_in_time) << k;
        }
    }
}

TEST(ArrivalAnchor, LostSamplesCount) {
    ArrivalAnchor anchor = anchor_of(600);
    std::int64_t samples = 0;
    for (std::int64_t k = 0; k < 1000; k += k % 7 == 0 ? 3 : 1) {
        samples += number_arrival(anchor, 1000 * k + (k % 2) * 600).steps;
        EXPECT_EQ(samples, k + 1);
    }
}

TEST(ArrivalAnchor, APeriodThatIsOnePercentOffIsFollowed) {
    for (const std::int64_t period_us : {990, 1010}) {
        ArrivalAnchor anchor = anchor_of(1000);
        for (std::int64_t k = 0; k < 10'000; ++k) {
            const ArrivalNumber number =
                number_arrival(anchor, period_us * k + (k % 3 == 0 ? 600 : 0));
            EXPECT_EQ(number.steps, 1U) << k;
            EXPECT_TRUE(number.is_in_time) << k;
        }
    }
}

TEST(ArrivalAnchor, MoreJitterThanAssumedIsFoundOnBothSides) {
    for (const std::int64_t late_us : {400, 440}) {
        ArrivalAnchor anchor = anchor_of(400);
        bool is_in_time = true;
        for (std::int64_t k = 0; k < 100; ++k) {
            is_in_time =
                number_arrival(anchor, 1000 * k + (k == 50 ? late_us : 0)).is_in_time && is_in_time;
        }
        EXPECT_EQ(is_in_time, late_us == 400);
    }
}

/// Frames of sample k of five axes, X at 100 mm/s, `late_us` late.
std::vector<CanFrame> frames_at(AxisEncoder& encoder, std::uint64_t k, std::int64_t late_us) {
    AxisSnapshot snapshot;
    snapshot.axis_count = 5;
    snapshot.latched_us = 1'000'000 + static_cast<std::int64_t>(k) * 1000 + late_us;
    snapshot.position[0] = 0.1 * static_cast<double>(k);
    return frames_of(encoder, snapshot);
}

// Sixteen periods were once numbered 24, and 100 mm/s bounded by 48.6 to 95.9.
TEST(ArrivalAnchor, SpeedsOfSignalsThatComeLateInTurnsHoldTheTrueOne) {
    Machine machine = five_axis_machine(CanFormat::signals);
    machine.axes[0].acceleration_max = 4000;
    AxisEncoder encoder(machine);
    AxisReceiver receiver(machine);
    Heard heard;
    for (std::uint64_t k = 0; k < 400; ++k) {
        listen(receiver, frames_at(encoder, k, k % 2 == 0 ? 0 : 600), heard);
    }
    EXPECT_TRUE(heard.faults.empty()) << fault_row(heard.faults.front().fault).name;
    ASSERT_EQ(heard.snapshots.size(), 400U);
    MotionHistory history;
    const SampleErrors errors = sample_errors(machine, 0, 1e-4);
    for (const AxisSnapshot& snapshot : heard.snapshots) {
        note_snapshot(history, snapshot, 1);
        const AxisRange range = range_of(history, 0, machine.axes[0], errors);
        EXPECT_LE(range.speed_low, 100) << snapshot.sample;
        EXPECT_GE(range.speed_high, 100) << snapshot.sample;
    }
    EXPECT_EQ(heard.snapshots.back().sample - heard.snapshots.front().sample, 399U);
}

// What lets a machine file state at most a quarter of a period: no loss that is borne costs a
// number.
TEST(ArrivalAnchor, AQuarterOfAPeriodOfJitterNumbersExactlyAfterTwentyLostSamples) {
    for (const std::int64_t period_us : {990, 1000, 1010}) {
        for (std::int64_t lost = 0; lost <= 20; ++lost) {
            for (const std::int64_t early_us : {0, 250}) {
                ArrivalAnchor anchor = anchor_of(250);
                for (std::int64_t k = 0; k < 100; ++k) {
                    (void)number_arrival(anchor, period_us * k + (k % 9 == 0 ? 250 : 0));
                }
                const ArrivalNumber number =
                    number_arrival(anchor, period_us * (100 + lost) + early_us);
                EXPECT_EQ(number.steps, lost + 1) << period_us;
                EXPECT_TRUE(number.is_in_time);
            }
        }
    }
}

TEST(ArrivalAnchor, TheStatedJitterOfSignalsIsEnforcedOnBothSidesAndBoundsTheirSpeeds) {
    for (const std::int64_t late_us : {200, 230}) {  // one percent of a period leaks each sample
        Machine machine = five_axis_machine(CanFormat::signals);
        machine.can.arrival_jitter_us = 200;
        EXPECT_NEAR(sample_errors(machine, 0, 0).latch_jitter_s, 210e-6, 1e-12);
        AxisEncoder encoder(machine);
        AxisReceiver receiver(machine);
        Heard heard;
        for (std::uint64_t k = 0; k < 60; ++k) {
            listen(receiver, frames_at(encoder, k, k == 40 ? late_us : 0), heard);
        }
        EXPECT_EQ(receiver.state() == ReceiverState::valid, late_us == 200);
        EXPECT_EQ(receiver.counters().of(ReceiverFault::arrival_jitter), late_us == 200 ? 0U : 1U);
    }
}

// The same positions, and a period less of doubt about their instants.
TEST(ArrivalAnchor, LessJitterKnowsTheSpeedBetter) {
    std::array<double, 2> width{};
    for (const std::uint32_t jitter_us : {0U, 100U}) {
        Machine machine = five_axis_machine(CanFormat::signals);
        machine.axes[0].acceleration_max = 4000;
        machine.can.arrival_jitter_us = jitter_us;
        AxisEncoder encoder(machine);
        AxisReceiver receiver(machine);
        Heard heard;
        for (std::uint64_t k = 0; k < 100; ++k) {
            listen(receiver, frames_at(encoder, k, k % 2 == 0 ? 0 : 100), heard);
        }
        MotionHistory history;
        AxisRange range;
        for (const AxisSnapshot& snapshot : heard.snapshots) {
            note_snapshot(history, snapshot, 1);
            range = range_of(history, 0, machine.axes[0], sample_errors(machine, 0, 1e-4));
            EXPECT_LE(range.speed_low, 100);
            EXPECT_GE(range.speed_high, 100);
        }
        width[jitter_us == 0 ? 0 : 1] = range.speed_high - range.speed_low;
    }
    EXPECT_LT(width[1], 0.8 * width[0]);
}

TEST(ArrivalAnchor, SignalsWithMoreThanAPeriodOfJitterStop) {
    const Machine machine = five_axis_machine(CanFormat::signals);
    AxisEncoder encoder(machine);
    AxisReceiver receiver(machine);
    Heard heard;
    for (std::uint64_t k = 0; k < 60; ++k) {
        listen(receiver, frames_at(encoder, k, k == 40 ? 980 : 0), heard);
    }
    EXPECT_EQ(receiver.state(), ReceiverState::valid);
    for (std::uint64_t k = 60; k < 80; ++k) {
        // A queue that empties slowly: at once would be a flood.
        const std::int64_t queue_us = 1450 - 350 * (static_cast<std::int64_t>(k) - 70);
        const std::int64_t late_us = k < 70 ? 0 : std::max<std::int64_t>(0, queue_us);
        listen(receiver, frames_at(encoder, k, late_us), heard);
    }
    EXPECT_EQ(receiver.state(), ReceiverState::invalid);
    EXPECT_STREQ(fault_row(receiver.stop_cause()).name, "arrival_jitter");
    // A person acknowledges, and everything is learnt anew.
    receiver.acknowledge();
    const std::size_t before = heard.snapshots.size();
    for (std::uint64_t k = 80; k < 90; ++k) {
        listen(receiver, frames_at(encoder, k, 300), heard);
    }
    EXPECT_EQ(heard.snapshots.size(), before + 10);
}

}  // namespace
}  // namespace axg
