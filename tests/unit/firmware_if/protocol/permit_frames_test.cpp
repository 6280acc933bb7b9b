// SPDX-License-Identifier: Apache-2.0
// The guard's side of the permit against the board's: its permits are those of the vectors,
// and the session frames of the library for boards are read, and nothing else is.
#include "firmware_if/protocol/permit_frames.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <string>

#include "tests/support/board_fixture.hpp"
#include "tests/support/frame_bytes.hpp"
#include "tests/support/json_value.hpp"

namespace axg {
namespace {

using test::hex_of;

CanFrame frame_of(const axg_board_can_frame& made) {
    CanFrame frame;
    frame.id = made.id;
    frame.fd = made.is_fd;
    frame.length_bytes = made.length;
    std::copy_n(made.data, made.length, frame.data.begin());
    return frame;
}

TEST(PermitWord, AnyTwoDifferInFourBitsAndNoneIsZero) {
    const unsigned words[] = {0xA5, 0xC3, 0x5A, 0x3C};
    EXPECT_EQ(static_cast<unsigned>(PermitWord::run), words[0]);
    EXPECT_EQ(static_cast<unsigned>(PermitWord::slow), words[1]);
    EXPECT_EQ(static_cast<unsigned>(PermitWord::stop), words[2]);
    EXPECT_EQ(static_cast<unsigned>(PermitWord::jog), words[3]);
    for (const unsigned a : words) {
        EXPECT_GE(std::popcount(a), 4);
        for (const unsigned b : words) {
            EXPECT_TRUE(a == b || std::popcount(a ^ b) >= 4);
        }
    }
}

TEST(PermitFrames, PermitsAreThoseOfTheVectors) {
    const auto vectors = test::Json::parse_file(AXG_SOURCE_DIR "/tests/vectors/permit2.json");
    ASSERT_GE(vectors["permits"].size(), 6U);
    for (const auto& one : vectors["permits"]) {
        SCOPED_TRACE(one["name"].get<std::string>());
        const Permit permit{.word = static_cast<PermitWord>(one["word"].get<int>()),
                            .sync_counter = one["echo"].get<std::uint8_t>(),
                            .live_counter = one["live"].get<std::uint8_t>(),
                            .known_answer_signature = 0xC5A3,
                            .cap = one["cap"].get<std::uint8_t>(),
                            .mask = one["mask"].get<std::uint8_t>(),
                            .samples = one["n"].get<std::uint8_t>(),
                            .level = one["level"].get<std::uint8_t>(),
                            .nonce = one["nonce"].get<std::uint32_t>(),
                            .lap = one["lap"].get<std::uint16_t>()};
        const auto pair = encode_permit({}, permit, 7);
        EXPECT_EQ(hex_of(pair[0]), one["plain"].get<std::string>());
        EXPECT_EQ(hex_of(pair[1]), one["twin"].get<std::string>());
        EXPECT_EQ(pair[0].id, 0x103U);
        EXPECT_EQ(pair[1].id, 0x104U);
        EXPECT_EQ(pair[1].time_us, 7);
    }
}

// With jog and stop a cap means nothing: it is sent as none, whatever it was.
TEST(PermitFrames, JogAndStopOrderNoCap) {
    for (const PermitWord word : {PermitWord::jog, PermitWord::stop}) {
        const auto pair = encode_permit({}, {.word = word, .cap = 20, .mask = 0xFF}, 0);
        EXPECT_EQ(pair[0].data[5], 250);
        EXPECT_EQ(pair[0].data[6], 0);
    }
}

TEST(PermitFrames, AProvenCycleIsAPermitForItsSample) {
    CycleResult result{.has_permit = true, .known_answer_signature = 0xC5A3, .samples = 15};
    const Permit run = permit_of(result, 42, 17);
    EXPECT_EQ(run.word, PermitWord::run);
    EXPECT_EQ(run.sync_counter, 17);
    EXPECT_EQ(run.live_counter, 42);
    EXPECT_EQ(run.known_answer_signature, 0xC5A3);
    EXPECT_EQ(run.cap, kPermitCapNone);
    EXPECT_EQ(run.mask, 0);
    EXPECT_EQ(run.samples, 15);
    EXPECT_EQ(run.level, 0);
    result.advisories.clearance_level = ClearanceLevel::warn;
    EXPECT_EQ(permit_of(result, 1, 1).level, 1);
    EXPECT_EQ(permit_of(result, 1, 1).word, PermitWord::run);
    result.advisories.clearance_level = ClearanceLevel::slow;
    EXPECT_EQ(permit_of(result, 1, 1).level, 2);
    EXPECT_EQ(permit_of(result, 1, 1).word, PermitWord::slow);
    result.advisories.clearance_level = ClearanceLevel::stop;
    EXPECT_EQ(permit_of(result, 1, 1).level, 3);
    result.known_answer_signature = 0x1234;
    EXPECT_EQ(permit_of(result, 1, 1).known_answer_signature, 0x1234) << "the engine's own";
}

// Without a promise of the board the cap is advice, for all axes; 0 would be an order to hold.
TEST(PermitFrames, TheSpeedCapIsAdviceForAllAxes) {
    CycleResult result{.has_permit = true};
    result.advisories.speed_cap = 60;
    EXPECT_EQ(permit_of(result, 1, 1).cap, 60);
    EXPECT_EQ(permit_of(result, 1, 1).mask, 0xFF);
    result.advisories.speed_cap = 0;
    EXPECT_EQ(permit_of(result, 1, 1).cap, 1);
}

// What was proven with a cap is sent with it, hold too; the advice of the same cycle is not.
TEST(PermitFrames, AnEnforcedCapIsWhatWasProven) {
    CycleResult result{.has_permit = true};
    result.advisories.speed_cap = 60;
    result.has_cap = true;
    EXPECT_EQ(permit_of(result, 1, 1).cap, kPermitCapNone);
    EXPECT_EQ(permit_of(result, 1, 1).mask, 0);
    result.cap_order = {.cap = 0, .mask = 0xFF};
    EXPECT_EQ(permit_of(result, 1, 1).cap, 0);
    EXPECT_EQ(permit_of(result, 1, 1).mask, 0xFF);
}

TEST(PermitFrames, ACycleWithoutAPermitHasNoSamples) {
    const Permit stop = permit_of({.samples = 3}, 1, 2);
    EXPECT_EQ(stop.word, PermitWord::stop);
    EXPECT_EQ(stop.samples, 0);
    EXPECT_EQ(stop.cap, kPermitCapNone);
}

TEST(PermitFrames, SessionFramesOfABoardAreRead) {
    test::BoardFixture fixture;
    fixture.arm();
    ASSERT_TRUE(fixture.latch_at(3 * AXG_BOARD_SYNC_MAX + 16, 100'000));
    axg_board_can_frame made{};
    ASSERT_TRUE(axg_board_encode_session(&fixture.board, {0x583, 0x583}, 100'000, &made));
    ASSERT_TRUE(axg_board_encode_session(&fixture.board, {0x583, 0x583}, 200'000, &made));
    Session session;
    ASSERT_EQ(decode_session(0x583, frame_of(made), session), FrameStatus::ok);
    EXPECT_EQ(session, (Session{.nonce = 0xC0FFEE, .lap = 3, .sync_counter = 17, .counter = 1}));
}

TEST(PermitFrames, ASessionThatIsPlayedIsThatOfTheLibrary) {
    test::BoardFixture fixture;
    fixture.arm();
    ASSERT_TRUE(fixture.latch_at(3 * AXG_BOARD_SYNC_MAX + 16, 100'000));
    axg_board_can_frame made{};
    ASSERT_TRUE(axg_board_encode_session(&fixture.board, {0x583, 0x583}, 0, &made));
    const CanFrame played =
        encode_session(0x583, {.nonce = 0xC0FFEE, .lap = 3, .sync_counter = 17, .counter = 0}, 9);
    EXPECT_EQ(hex_of(played), hex_of(frame_of(made)));
    EXPECT_EQ(played.id, 0x583U);
    EXPECT_EQ(played.time_us, 9);
}

TEST(PermitFrames, WhatIsNotExactlyASessionFrameIsRefused) {
    test::BoardFixture fixture;
    fixture.arm();
    ASSERT_TRUE(fixture.latch_at(16, 100'000));
    axg_board_can_frame made{};
    ASSERT_TRUE(axg_board_encode_session(&fixture.board, {0x583, 0x583}, 0, &made));
    const CanFrame good = frame_of(made);
    Session session{.nonce = 5};
    const auto expect = [&](const char* what, FrameStatus status, auto&& spoil) {
        CanFrame bad = good;
        spoil(bad);
        EXPECT_EQ(decode_session(0x583, bad, session), status) << what;
    };
    for (unsigned bit = 0; bit < 64; ++bit) {
        expect("a bit", FrameStatus::bad_crc, [bit](CanFrame& bad) {
            bad.data[bit / 8] ^= static_cast<std::uint8_t>(1U << bit % 8);
        });
    }
    expect("length", FrameStatus::bad_length, [](CanFrame& bad) { bad.length_bytes = 7; });
    expect("flexible", FrameStatus::bad_format, [](CanFrame& bad) { bad.fd = true; });
    expect("length code", FrameStatus::raw_dlc, [](CanFrame& bad) { bad.raw_dlc = 9; });
    expect("id", FrameStatus::not_ours, [](CanFrame& bad) { ++bad.id; });
    expect("extended", FrameStatus::not_ours, [](CanFrame& bad) { bad.extended = true; });
    expect("remote", FrameStatus::not_ours, [](CanFrame& bad) { bad.remote = true; });
    expect("error", FrameStatus::not_ours, [](CanFrame& bad) { bad.error = true; });
    const auto seal = [](CanFrame& bad) {
        bad.data[0] = classical_crc(std::span<const std::uint8_t, 8>(bad.data.data(), 8), 0x583);
    };
    for (const int sync : {0, 241}) {
        expect("SYNC counter", FrameStatus::bad_format, [&](CanFrame& bad) {
            bad.data[2] = static_cast<std::uint8_t>(sync);
            seal(bad);
        });
    }
    expect("version", FrameStatus::bad_format, [&](CanFrame& bad) {
        bad.data[1] = 0x20;
        seal(bad);
    });
    EXPECT_EQ(session, Session{.nonce = 5});
}

}  // namespace
}  // namespace axg
