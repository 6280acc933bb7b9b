// SPDX-License-Identifier: Apache-2.0
// What a display reads is what the guard wrote, and damaged frames are nothing.
#include "firmware_if/protocol/seen_frames.hpp"

#include <gtest/gtest.h>

namespace axg {
namespace {

TEST(SeenFrames, APairIsReadBackWithTheAnswerOfItsSession) {
    const Permit permit{.word = PermitWord::slow,
                        .sync_counter = 17,
                        .live_counter = 42,
                        .known_answer_signature = 0xC5A3,
                        .cap = 60,
                        .mask = 6,
                        .samples = 10,
                        .level = 2,
                        .nonce = 0xC0FFEE,
                        .lap = 3};
    const auto pair = encode_permit({}, permit, 7);
    const auto seen = read_permit({}, pair[0], pair[1]);
    ASSERT_TRUE(seen);
    EXPECT_EQ(seen->permit.word, PermitWord::slow);
    EXPECT_EQ(seen->permit.sync_counter, 17);
    EXPECT_EQ(seen->permit.live_counter, 42);
    EXPECT_EQ(seen->permit.cap, 60);
    EXPECT_EQ(seen->permit.mask, 6);
    EXPECT_EQ(seen->permit.samples, 10);
    EXPECT_EQ(seen->permit.level, 2);
    Permit answered = seen->permit;
    answered.nonce = 0xC0FFEE;
    answered.lap = 3;
    EXPECT_EQ(answer_of({}, answered), seen->answer);
    answered.lap = 4;
    EXPECT_NE(answer_of({}, answered), seen->answer);
}

TEST(SeenFrames, APairWithAnyBitChangedInOneFrameIsNone) {
    const auto pair = encode_permit(
        {}, {.word = PermitWord::run, .sync_counter = 1, .live_counter = 1, .samples = 3}, 7);
    ASSERT_TRUE(read_permit({}, pair[0], pair[1]));
    for (unsigned bit = 0; bit < 64; ++bit) {
        for (const unsigned frame : {0U, 1U}) {
            auto damaged = pair;
            damaged[frame].data[bit / 8] =
                static_cast<std::uint8_t>(damaged[frame].data[bit / 8] ^ (1U << bit % 8));
            EXPECT_FALSE(read_permit({}, damaged[0], damaged[1])) << frame << ' ' << bit;
        }
    }
    auto shapes = pair;
    shapes[1].length_bytes = 7;
    EXPECT_FALSE(read_permit({}, shapes[0], shapes[1]));
    EXPECT_FALSE(read_permit({}, pair[1], pair[0]));
}

TEST(SeenFrames, AStatusIsReadBackAndADamagedOneIsNot) {
    const OperatorStatus status{.phase = GuardPhase::armed,
                                .action = OperatorAction::reset,
                                .refusal = OperatorRefusal::too_late,
                                .counter = 9,
                                .nonce = 0x123456};
    const CanFrame frame = encode_operator_status({}, status, 5);
    const auto read = read_operator_status({}, frame);
    ASSERT_TRUE(read);
    EXPECT_EQ(read->phase, GuardPhase::armed);
    EXPECT_EQ(read->action, OperatorAction::reset);
    EXPECT_EQ(read->refusal, OperatorRefusal::too_late);
    EXPECT_EQ(read->counter, 9);
    EXPECT_EQ(read->nonce, 0x123456U);
    for (unsigned bit = 0; bit < 64; ++bit) {
        CanFrame damaged = frame;
        damaged.data[bit / 8] = static_cast<std::uint8_t>(damaged.data[bit / 8] ^ (1U << bit % 8));
        EXPECT_FALSE(read_operator_status({}, damaged)) << bit;
    }
}

TEST(SeenFrames, HintsAreReadBackAndNothingElseIs) {
    const CanFrame frame =
        encode_hints({}, {.sync_counter = 17, .pair = 0x0203, .distance_10um = 0x0405}, 9);
    const auto read = read_hints({}, frame);
    ASSERT_TRUE(read);
    EXPECT_EQ(read->sync_counter, 17);
    EXPECT_EQ(read->pair, 0x0203);
    EXPECT_EQ(read->distance_10um, 0x0405);
    using Damage = void (*)(CanFrame&);
    constexpr Damage kDamages[]{
        [](CanFrame& f) { f.id = 0x683; },       [](CanFrame& f) { f.fd = true; },
        [](CanFrame& f) { f.length_bytes = 4; }, [](CanFrame& f) { f.length_bytes = 6; },
        [](CanFrame& f) { f.extended = true; },  [](CanFrame& f) { f.remote = true; },
        [](CanFrame& f) { f.error = true; },     [](CanFrame& f) { f.raw_dlc = 9; }};
    for (const Damage damage : kDamages) {
        CanFrame damaged = frame;
        damage(damaged);
        EXPECT_FALSE(read_hints({}, damaged));
    }
}

}  // namespace
}  // namespace axg
