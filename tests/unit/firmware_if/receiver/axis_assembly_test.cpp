// SPDX-License-Identifier: Apache-2.0
// Receiver rules 5, 6, 9 and 10 of docs/reference/protocol.md: one sample index in a snapshot, the
// instant of a sample, how many may be lost, and what "in a row" means.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>

#include "tests/support/receiver_fixture.hpp"

namespace axg {
namespace {

using namespace test;

// The next sample has the very frame that this one lacks: together they would be complete, and of
// two instants.
TEST(AxisAssembly, AFrameOfTheNextSampleDoesNotCompleteThisOne) {
    for (const std::size_t lost : {kFirst, kSecond, kThird}) {
        Fixture fixture;
        auto& frames = fixture.samples[20];
        frames.erase(frames.begin() + static_cast<std::ptrdiff_t>(lost));
        fixture.hear();
        fixture.expect_running_without(1);
        EXPECT_EQ(fixture.count(ReceiverFault::torn), 1U);
        for (const AxisSnapshot& snapshot : fixture.heard.snapshots) {
            const AxisSnapshot sent = snapshot_at(fixture.machine, snapshot.sample);
            for (std::size_t i = 0; i < 4; ++i) {
                EXPECT_NEAR(snapshot.position[i], sent.position[i], 0.51e-3) << snapshot.sample;
            }
        }
    }
}

/// The first axis frame overtakes SYNC, which a queue held up for 100 us.
void put_sync_behind_the_first_frame(std::vector<CanFrame>& frames) {
    const std::int64_t latched_us = frames[kSync].time_us;
    std::swap(frames[kSync], frames[kFirst]);
    frames[0].time_us = latched_us + 10;
    frames[1].time_us = latched_us + 100;
}

/// SYNC is lost, and the frames come before the instant at which it was expected.
void lose_sync_and_hurry(std::vector<CanFrame>& frames) {
    const std::int64_t latched_us = frames[kSync].time_us;
    frames.erase(frames.begin());
    for (CanFrame& frame : frames) {
        frame.time_us = latched_us - 50;
    }
}

// A sample that looks younger than it is makes its permit last too long. What an axis frame carries
// was latched before that frame was sent, whatever SYNC or the period says.
TEST(AxisAssembly, NoInstantIsLaterThanTheFirstFrameOfItsSample) {
    for (const auto change : {put_sync_behind_the_first_frame, lose_sync_and_hurry}) {
        for (const std::size_t changed : {0U, 21U}) {
            Fixture fixture;
            change(fixture.samples[changed]);
            fixture.hear();
            // Without SYNC the first sample has no instant at all.
            const bool is_dropped = change == lose_sync_and_hurry && changed == 0;
            fixture.expect_running_without(is_dropped ? 1 : 0);
            for (const AxisSnapshot& snapshot : fixture.heard.snapshots) {
                const auto& frames = fixture.samples[snapshot.sample + (is_dropped ? 1 : 0)];
                const auto first = std::find_if(
                    frames.begin(), frames.end(),
                    [](const CanFrame& frame) { return frame.id != 0x080 && frame.id != 0x701; });
                EXPECT_LE(snapshot.latched_us, first->time_us) << snapshot.sample;
            }
        }
    }
}

// The earlier stamp is the safe one.
TEST(AxisAssembly, ARepeatedSyncDoesNotMakeItsSampleYounger) {
    Fixture fixture;
    auto& frames = fixture.samples[20];
    CanFrame again = frames[kSync];
    again.time_us += 50;
    frames[kFirst].time_us = std::max(frames[kFirst].time_us, again.time_us);
    frames.insert(frames.begin() + kFirst, again);
    fixture.hear();
    fixture.expect_running_without(0);
    EXPECT_EQ(fixture.count(ReceiverFault::repeated), 1U);
    EXPECT_EQ(fixture.heard.snapshots[20].latched_us, snapshot_at(fixture.machine, 20).latched_us);
}

// A queue that fills: each SYNC is 0.15 periods later than the one before, and so is its sample.
// What is held up must not look younger: the base follows by 1 % of a period, and the age grows.
TEST(AxisAssembly, AQueueThatFillsMakesItsSamplesOlder) {
    Fixture fixture(CanFormat::classical, 13);
    for (std::size_t k = 0; k < fixture.samples.size(); ++k) {
        for (CanFrame& frame : fixture.samples[k]) {
            frame.time_us += 150 * static_cast<std::int64_t>(k);
        }
    }
    fixture.hear();
    fixture.expect_running_without(0);
    const auto age_us = [&fixture](std::size_t k) {
        const AxisSnapshot& snapshot = fixture.heard.snapshots[k];
        return snapshot.arrived_us - snapshot.latched_us;
    };
    for (std::size_t k = 3; k < fixture.samples.size(); ++k) {
        EXPECT_GE(age_us(k), age_us(k - 1) + 130) << k;  // 150, less what the base may follow by
    }
    EXPECT_GT(age_us(12), age_us(0) + 1300);
}

TEST(AxisAssembly, TheSendersClockMayBeOffByAFifthOfThePeriodAndNoMore) {
    for (const int off_us : {-201, -200, 200, 201}) {
        Fixture fixture(CanFormat::fd);
        CanFrame& frame = fixture.samples[20][kFirst];
        std::uint32_t sender_us = 0;
        std::memcpy(&sender_us, frame.data.data() + 24, 4);
        sender_us += static_cast<std::uint32_t>(off_us);
        std::memcpy(frame.data.data() + 24, &sender_us, 4);
        p05_protect({frame.data.data(), frame.length_bytes}, 0x0181, frame.data[2]);
        fixture.hear();
        const bool is_refused = off_us < -200 || off_us > 200;
        fixture.expect_running_without(is_refused ? 1 : 0);
        EXPECT_EQ(fixture.count(ReceiverFault::sender_clock), is_refused ? 1U : 0U) << off_us;
    }
}

// Each overflow of the queue adds 3, so does the lost sample, and the next snapshot takes 1: 59 is
// borne, 62 is not.
TEST(AxisAssembly, TheCountOfLostSamplesStopsAboveItsLimit) {
    for (const std::size_t overflows : {19U, 20U}) {
        Fixture fixture;
        CanFrame overflow;
        overflow.error = true;
        overflow.id = 0x004;
        overflow.length_bytes = 8;
        overflow.data[1] = 0x01;
        overflow.time_us = fixture.samples[20][kSync].time_us;
        fixture.samples[20].assign(overflows, overflow);
        fixture.hear();
        EXPECT_EQ(fixture.count(ReceiverFault::rx_overflow), overflows);
        if (overflows == 19) {
            fixture.expect_running_without(1);
        } else {
            fixture.expect_stop(ReceiverFault::loss_limit);
        }
    }
}

// One snapshot, a hole and another one are not two in a row: the row begins anew after the hole.
TEST(AxisAssembly, SnapshotsWithAHoleBetweenThemAreNotInARow) {
    Fixture fixture;
    listen(fixture.receiver, fixture.samples[0], fixture.heard);
    listen(fixture.receiver, fixture.samples[2], fixture.heard);
    EXPECT_EQ(fixture.heard.snapshots.size(), 2U);
    EXPECT_EQ(fixture.receiver.state(), ReceiverState::init);
    listen(fixture.receiver, fixture.samples[3], fixture.heard);
    EXPECT_EQ(fixture.receiver.state(), ReceiverState::valid);
}

}  // namespace
}  // namespace axg
