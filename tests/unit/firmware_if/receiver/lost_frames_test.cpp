// SPDX-License-Identifier: Apache-2.0
// How many frames of one identifier may be lost in a row, and what that costs.
#include <gtest/gtest.h>

#include "firmware_if/receiver/axis_receiver.hpp"
#include "tests/support/receiver_fixture.hpp"

namespace axg {
namespace {

using namespace test;

Fixture heard_without(std::size_t lost) {
    Fixture fixture;
    for (std::size_t k = 20; k < 20 + lost; ++k) {
        fixture.samples[k].erase(fixture.samples[k].begin() + kSecond);
    }
    fixture.machine.can.stale_after_us = 12 * fixture.machine.can.sample_us;
    fixture.receiver = AxisReceiver(fixture.machine);
    fixture.hear();
    return fixture;
}

// A wrong sequence would cost two samples more, while the last permit runs out.
TEST(LostFrames, FiveOfOneIdentifierCostFiveSamples) {
    for (std::size_t lost = 1; lost <= 5; ++lost) {
        const Fixture fixture = heard_without(lost);
        EXPECT_EQ(fixture.count(ReceiverFault::wrong_sequence), 0U);
        EXPECT_EQ(fixture.heard.snapshots.size(), fixture.samples.size() - lost);
        EXPECT_EQ(fixture.receiver.state(), ReceiverState::valid);
    }
}

// The hole is then eight samples long, and four bits of an index say that the next is older.
TEST(LostFrames, SixAreAWrongSequenceAndTooLongAHole) {
    const Fixture fixture = heard_without(6);
    EXPECT_EQ(fixture.count(ReceiverFault::wrong_sequence), 2U);
    EXPECT_EQ(fixture.receiver.stop_cause(), ReceiverFault::stale);
}

}  // namespace
}  // namespace axg
