// SPDX-License-Identifier: Apache-2.0
// The wire in memory: one frame at a time, arbitration by id, bit times, and each fault.
#include "hil_replay/board/can_bus.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace axg {
namespace {

CanFrame frame_of(std::uint32_t id, std::int64_t ready_us, std::uint8_t length = 8) {
    CanFrame frame;
    frame.id = id;
    frame.time_us = ready_us;
    frame.length_bytes = length;
    return frame;
}

std::vector<CanBus::Delivery> all_until(CanBus& bus, std::int64_t until_us) {
    std::vector<CanBus::Delivery> all;
    CanBus::Delivery one;
    while (bus.next(until_us, one)) {
        all.push_back(one);
    }
    return all;
}

TEST(CanBus, TheLowestIdOfThoseReadyGoesFirstAndNobodyIsInterrupted) {
    CanBus bus({});
    bus.post(BusNode::board, frame_of(0x381, 0));
    bus.post(BusNode::board, frame_of(0x181, 1));  // comes while 0x381 is on the wire
    bus.post(BusNode::guard, frame_of(0x103, 100));
    bus.post(BusNode::board, frame_of(0x080, 500, 1));
    const auto all = all_until(bus, 10000);
    ASSERT_EQ(all.size(), 4U);
    EXPECT_EQ(all[0].frame.id, 0x381U);
    EXPECT_EQ(all[0].frame.time_us, 135);
    EXPECT_EQ(all[1].frame.id, 0x103U);
    EXPECT_EQ(all[1].sender, BusNode::guard);
    EXPECT_EQ(all[1].frame.time_us, 270);
    EXPECT_EQ(all[2].frame.id, 0x181U);
    EXPECT_EQ(all[3].frame.time_us, 565);  // the wire was free
    EXPECT_EQ(bus.busy_us(), 3U * 135 + 65);
}

TEST(CanBus, AFrameArrivesWhenItsLastBitIsThrough) {
    CanBus bus({});
    bus.post(BusNode::board, frame_of(0x181, 1000));
    EXPECT_TRUE(all_until(bus, 1134).empty());
    EXPECT_EQ(all_until(bus, 1135).size(), 1U);
}

TEST(CanBus, EqualIdsKeepTheirOrder) {
    CanBus bus({});
    for (std::uint8_t i = 0; i < 5; ++i) {
        CanFrame frame = frame_of(0x001, 0);
        frame.data[0] = i;
        bus.post(BusNode::guard, frame);
    }
    const auto all = all_until(bus, 10000);
    ASSERT_EQ(all.size(), 5U);
    for (std::uint8_t i = 0; i < 5; ++i) {
        EXPECT_EQ(all[i].frame.data[0], i);
    }
}

/// How many of 10,000 frames of a node and an id come through.
std::size_t arrived(const BusFaults& faults, BusNode sender, std::uint32_t id) {
    BusOptions options;
    options.faults = faults;
    CanBus bus(options);
    std::size_t count = 0;
    for (std::int64_t i = 0; i < 10000; ++i) {
        bus.post(sender, frame_of(id, i * 1000));
        for (const CanBus::Delivery& delivery : all_until(bus, i * 1000 + 999)) {
            count += delivery.is_lost ? 0 : 1;  // its sender hears it back
        }
    }
    return count;
}

TEST(CanBus, LosesTheShareAskedForOfEitherNode) {
    BusFaults faults;
    faults.lost = 0.05;
    EXPECT_NEAR(static_cast<double>(arrived(faults, BusNode::board, 0x181)), 9500, 100);
    EXPECT_NEAR(static_cast<double>(arrived(faults, BusNode::guard, 0x001)), 9500, 100);
    EXPECT_EQ(arrived({}, BusNode::guard, 0x001), 10000U);
}

TEST(CanBus, LostPermitsLeaveTheRestAlone) {
    BusFaults faults;
    faults.permit_lost = 0.25;
    EXPECT_NEAR(static_cast<double>(arrived(faults, BusNode::guard, 0x104)), 7500, 200);
    EXPECT_EQ(arrived(faults, BusNode::guard, 0x001), 10000U);
    EXPECT_EQ(arrived(faults, BusNode::board, 0x103), 10000U);
}

TEST(CanBus, FaultsThatBeginAtAnInstantBeginThere) {
    BusFaults silent, killed, stuck;
    silent.silent_from_us = killed.killed_from_us = stuck.stuck_from_us = 4'000'000;
    for (const BusNode sender : {BusNode::board, BusNode::guard}) {
        const bool is_guard = sender == BusNode::guard;
        EXPECT_EQ(arrived(silent, sender, 0x702), 4000U);
        EXPECT_EQ(arrived(killed, sender, 0x702), is_guard ? 4000U : 10000U);
        EXPECT_EQ(arrived(stuck, sender, 0x702), 10000U) << "its heart still beats";
        EXPECT_EQ(arrived(stuck, sender, 0x103), is_guard ? 4000U : 10000U);
    }
}

TEST(CanBus, LateIsOnePeriodAndTheGuardsAlone) {
    BusOptions options;
    options.period_us = 2000;
    options.faults.late_from_us = 5000;
    CanBus bus(options);
    bus.post(BusNode::guard, frame_of(0x103, 4999));
    bus.post(BusNode::guard, frame_of(0x104, 5000));
    bus.post(BusNode::board, frame_of(0x181, 5000));
    const auto all = all_until(bus, 100000);
    ASSERT_EQ(all.size(), 3U);
    EXPECT_EQ(all[0].frame.time_us, 4999 + 135);
    EXPECT_EQ(all[1].frame.id, 0x181U);
    EXPECT_EQ(all[2].frame.time_us, 7000 + 135);
}

TEST(CanBus, CorruptedPermitsDifferInOneToThreeBits) {
    BusOptions options;
    options.faults.corrupted = 1;
    CanBus bus(options);
    for (std::int64_t i = 0; i < 1000; ++i) {
        bus.post(BusNode::guard, frame_of(0x103, i * 1000));
        bus.post(BusNode::board, frame_of(0x181, i * 1000));
    }
    std::uint64_t turned_max = 0;
    for (const CanBus::Delivery& delivery : all_until(bus, 10'000'000)) {
        std::uint64_t turned = 0;
        for (const std::uint8_t byte : delivery.frame.data) {
            turned += static_cast<std::uint64_t>(__builtin_popcount(byte));
        }
        turned_max = std::max(turned_max, turned);
        EXPECT_EQ(turned > 0, delivery.sender == BusNode::guard);
        EXPECT_LE(turned, 3U);
    }
    EXPECT_EQ(turned_max, 3U);
}

}  // namespace
}  // namespace axg
