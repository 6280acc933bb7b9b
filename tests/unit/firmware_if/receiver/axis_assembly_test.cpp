// SPDX-License-Identifier: Apache-2.0
// Receiver rules 6 and 10 of docs/protocol.md: the instant of a sample, and what "in a row" means.
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/support/receiver_fixture.hpp"

namespace axg {
namespace {

using namespace test;

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
