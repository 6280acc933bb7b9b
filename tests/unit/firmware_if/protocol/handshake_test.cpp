// SPDX-License-Identifier: Apache-2.0
// Board and guard compare what they were configured with: nothing is permitted before all four
// hashes are the same, a difference stops at any time, and a person is told which and both values.
#include "firmware_if/protocol/handshake.hpp"

#include <gtest/gtest.h>

#include "config/machine/effective_text.hpp"
#include "tests/support/live_world.hpp"
#include "tests/support/replay_fixture.hpp"

namespace axg {
namespace {

constexpr std::uint32_t kIn = 0x582, kOut = 0x602;

TEST(HashFrameTest, OnlyExactlySuchAFrameIsRead) {
    const CanFrame good = encode_hash(kIn, {.part = 3, .hash = 0x12345678}, 7);
    HashFrame read;
    ASSERT_TRUE(decode_hash(good, read));
    EXPECT_EQ(read.part, 3);
    EXPECT_EQ(read.hash, 0x12345678U);
    EXPECT_EQ(good.data[4], 0x78) << "the low byte first";
    const std::array<void (*)(CanFrame&), 9> damages{
        [](CanFrame& f) { f.data[0] = 4; },      [](CanFrame& f) { f.data[1] = 2; },
        [](CanFrame& f) { f.data[2] = 1; },      [](CanFrame& f) { f.data[3] = 1; },
        [](CanFrame& f) { f.length_bytes = 7; }, [](CanFrame& f) { f.fd = true; },
        [](CanFrame& f) { f.extended = true; },  [](CanFrame& f) { f.remote = true; },
        [](CanFrame& f) { f.error = true; }};
    for (std::size_t i = 0; i < damages.size(); ++i) {
        CanFrame bad = good;
        damages[i](bad);
        EXPECT_FALSE(decode_hash(bad, read)) << i;
    }
}

class HandshakeWorld : public testing::Test {
  protected:
    HandshakeWorld() {
        world.machine.can.hashes_in_id = kIn;
        world.machine.can.hashes_out_id = kOut;
        world.options.hashes.of = {0x11111111, 0x22222222, 0x33333333, 0x44444444};
        world.start();
    }
    const Guard& guard() const { return world.guard->guard(); }
    std::size_t permits() const { return world.count_permits(); }
    std::vector<LiveNote> notes() {
        std::vector<LiveNote> out;
        LiveNote note;
        while (world.queues->notes.pop(note)) {
            out.push_back(note);
        }
        return out;
    }
    EmergencyCode last_emergency() const {
        Emergency last;
        for (const CanFrame& frame : world.wire.sent) {
            Emergency read;
            if (decode_emergency(world.machine.can, frame, read) == GuardFrameStatus::ok) {
                last = read;
            }
        }
        return last.code;
    }
    /// The board says another number for one part.
    void differ(std::uint8_t part) {
        world.says_hash = [this, part](HashFrame& hash) {
            hash.hash = world.options.hashes.of[hash.part] ^ (hash.part == part ? 1U : 0U);
            return true;
        };
    }

    LatchCell latch{kLatchClear, ~kLatchClear};
    test::LiveWorld world{CanFormat::classical, latch};
};

TEST_F(HandshakeWorld, ABoardThatSaysTheSameIsPermittedAndAskedNoMore) {
    world.run_periods(100);
    ASSERT_EQ(guard().phase, GuardPhase::ready);
    const std::size_t asked = world.count_sent(kOut);
    EXPECT_GE(asked, 4U);
    world.guard->arm(world.wire.now_us);
    world.run_periods(200);
    EXPECT_EQ(guard().phase, GuardPhase::armed);
    EXPECT_GT(permits(), 190U);
    EXPECT_EQ(world.count_sent(kOut), asked);
}

TEST_F(HandshakeWorld, EachPartAloneStopsAndSaysBothHashes) {
    for (std::uint8_t part = 0; part < kHashParts; ++part) {
        set_latch(latch, false);
        differ(part);
        world.start();
        notes();
        world.run_periods(100);
        EXPECT_EQ(guard().phase, GuardPhase::stopped);
        EXPECT_EQ(guard().cause, GuardFault::refused);
        EXPECT_TRUE(is_latched(latch));
        EXPECT_EQ(last_emergency(), EmergencyCode::model_hash);
        std::size_t told = 0;
        for (const LiveNote& note : notes()) {
            if (note.kind == LiveNote::Kind::hashes) {
                ++told;
                EXPECT_STREQ(note.words, kHashPartNames[part]);
                EXPECT_EQ(note.ours, world.options.hashes.of[part]);
                EXPECT_EQ(note.theirs, world.options.hashes.of[part] ^ 1U);
            }
        }
        EXPECT_GE(told, 1U);
        world.guard->arm(world.wire.now_us);
        world.run_periods(50);
        EXPECT_EQ(permits(), 0U);
    }
}

TEST_F(HandshakeWorld, ABoardThatIsSetRightIsPermittedAfterAReset) {
    differ(2);
    world.run_periods(100);
    ASSERT_EQ(guard().cause, GuardFault::refused);
    world.stands_still = true;
    world.says_hash = [this](HashFrame& hash) {
        hash.hash = world.options.hashes.of[hash.part];
        return true;
    };
    world.run_periods(world.kStandPeriods);
    world.guard->reset(world.wire.now_us);
    world.stands_still = false;
    world.run_periods(140);  // until the board's next session frame
    EXPECT_EQ(guard().phase, GuardPhase::ready) << to_text(guard().cause);
}

TEST_F(HandshakeWorld, ABoardThatSaysNothingIsNeverPermittedAndAPersonIsToldOnce) {
    world.says_hash = [](HashFrame& hash) { return hash.part != 1; };  // all but one part
    world.run_periods(3000);
    EXPECT_EQ(guard().phase, GuardPhase::selftest);
    world.guard->arm(world.wire.now_us);
    world.run_periods(50);
    EXPECT_EQ(permits(), 0U);
    std::size_t told = 0;
    for (const LiveNote& note : notes()) {
        told += note.kind == LiveNote::Kind::wire && note.frame_id == kIn ? 1U : 0U;
    }
    EXPECT_EQ(told, 1U);
    EXPECT_GT(world.count_sent(kOut), 250U) << "it is asked again every 10 ms";
}

// A tool table that was changed on the board while the machine runs.
TEST_F(HandshakeWorld, AnotherHashWhileArmedStops) {
    world.run_periods(100);
    world.guard->arm(world.wire.now_us);
    world.run_periods(50);
    ASSERT_EQ(guard().phase, GuardPhase::armed);
    const HashFrame same{.part = 2, .hash = world.options.hashes.of[2]};
    world.wire.arrive(encode_hash(kIn, same, world.wire.now_us));
    world.run_periods(10);
    ASSERT_EQ(guard().phase, GuardPhase::armed) << "the same hash again is nothing new";
    world.wire.arrive(encode_hash(kIn, {.part = 2, .hash = 5}, world.wire.now_us));
    const std::int64_t said_us = world.wire.now_us;
    world.run_periods(10);
    EXPECT_EQ(guard().phase, GuardPhase::stopped);
    EXPECT_EQ(guard().cause, GuardFault::refused);
    EXPECT_EQ(world.count_sent(world.machine.can.permit_id, said_us + 200), 0U);
}

TEST_F(HandshakeWorld, OurHashesFromAnotherSenderAreASecondGuard) {
    world.run_periods(100);
    world.wire.arrive(encode_hash(kOut, {.part = 0, .hash = 1}, world.wire.now_us));
    world.run_periods(2);
    EXPECT_EQ(guard().cause, GuardFault::second_guard);
}

TEST_F(HandshakeWorld, BothIdsPassTheKernelsFilters) {
    std::array<std::uint32_t, 64> ids{};
    const std::uint32_t count = live_ids(world.machine, ids);
    const auto has = [&](std::uint32_t id) {
        return std::find(ids.begin(), ids.begin() + count, id) != ids.begin() + count;
    };
    EXPECT_TRUE(has(kIn) && has(kOut));
    world.machine.can.hashes_in_id = world.machine.can.hashes_out_id = 0;
    EXPECT_EQ(live_ids(world.machine, ids), count - 2);
}

// What goes into which: a change of each kind changes its own part and no other.
TEST(ConfigurationHashesTest, AChangeOfEachKindChangesItsOwnPart) {
    const test::Workshop shop;
    const std::string text = test::content_of(test::kPaperMachine);
    const auto hashes_of = [&](const std::string& from, const std::string& to) {
        std::string changed = text;
        const std::size_t at = changed.find(from);
        EXPECT_NE(at, std::string::npos) << from;
        changed.replace(at, from.size(), to);
        LoadedMachine loaded;
        EXPECT_TRUE(load(shop.write("machine.yaml", changed), test::source_file("config/machines"),
                         loaded, stderr));
        return configuration_hashes(loaded.machine, loaded.meshes);
    };
    const ConfigurationHashes usual = hashes_of("version: 1", "version: 1");
    const auto parts_changed = [&](const std::string& from, const std::string& to) {
        const ConfigurationHashes other = hashes_of(from, to);
        std::string parts;
        for (std::size_t i = 0; i < kHashParts; ++i) {
            parts += other.of[i] != usual.of[i] ? kHashPartNames[i] + std::string(" ") : "";
        }
        return parts;
    };
    EXPECT_EQ(parts_changed("name: paper-trunnion", "name: another"), "");
    EXPECT_EQ(parts_changed("margin_mm: 0}", "margin_mm: 0.25}"), "model ");
    EXPECT_EQ(parts_changed("free_jerk: limited", "free_jerk: any"), "limits ");
    EXPECT_EQ(parts_changed("length_mm: 140", "length_mm: 141"), "tools ");
    EXPECT_EQ(parts_changed("pivot_mm: [0", "pivot_mm: [1"), "kinematics ");
}

}  // namespace
}  // namespace axg
