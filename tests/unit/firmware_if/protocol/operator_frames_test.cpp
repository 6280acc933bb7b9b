// SPDX-License-Identifier: Apache-2.0
// The guard's side of an operator's frames against the library of the panel's side, which shares no
// code with it, and against the vectors that a script of Python wrote.
#include "firmware_if/protocol/operator_frames.hpp"

#include <gtest/gtest.h>

#include <random>
#include <string>

#include "firmware_if/protocol/e2e.hpp"
#include "tests/support/frame_bytes.hpp"
#include "tests/support/json_value.hpp"
#include "tests/support/operator_panel.hpp"
#include "tests/support/seed.hpp"

namespace axg {
namespace {

using test::hex_of;

const CanLayout kUsualLayout;

TEST(OperatorFrames, TheStatusIsTheOneThatTheLibraryWrites) {
    for (unsigned phase = 0; phase < kGuardPhases; ++phase) {
        for (const unsigned action : {0x00U, 0x96U, 0x69U}) {
            for (unsigned refusal = 0; refusal < kOperatorRefusals; ++refusal) {
                const auto counter = static_cast<std::uint8_t>((phase + refusal) & 15U);
                const std::uint32_t nonce = 0x123456 + action;
                const CanFrame made =
                    encode_operator_status(kUsualLayout,
                                           {.phase = static_cast<GuardPhase>(phase),
                                            .action = static_cast<OperatorAction>(action),
                                            .refusal = static_cast<OperatorRefusal>(refusal),
                                            .counter = counter,
                                            .nonce = nonce},
                                           77);
                const axg_operator_status same{
                    .phase = static_cast<std::uint8_t>(phase),
                    .action = static_cast<axg_operator_action>(action),
                    .refusal = static_cast<axg_operator_refusal>(refusal),
                    .counter = counter,
                    .nonce = nonce};
                axg_board_can_frame theirs{};
                axg_operator_encode_status(&same, test::kOperatorOut, &theirs);
                const CanFrame wanted = test::frame_of(theirs, 77);
                EXPECT_EQ(made.data, wanted.data) << phase << ' ' << action << ' ' << refusal;
                EXPECT_EQ(made.id, wanted.id);
                EXPECT_EQ(made.length_bytes, wanted.length_bytes);
                EXPECT_EQ(made.time_us, 77);
                ASSERT_TRUE(test::status_in(made));
                EXPECT_EQ(test::status_in(made)->nonce, nonce);
            }
        }
    }
}

// Bytes that are mostly right: what either side takes, the other takes too, with the same content.
TEST(OperatorFrames, BothSidesTakeTheSameMessages) {
    std::mt19937_64 random(test::printed_seed(21));
    constexpr std::array<std::uint8_t, 4> kActions{0x96, 0x69, 0x00, 0x97};
    constexpr std::array<std::uint8_t, 4> kSteps{0x0F, 0xF0, 0x00, 0x0E};
    std::uint64_t taken = 0;
    for (int i = 0; i < 200'000; ++i) {
        CanFrame frame;
        frame.id = 0x584;
        frame.length_bytes = 8;
        for (std::uint8_t& byte : std::span(frame.data).first(8)) {
            byte = static_cast<std::uint8_t>(random());
        }
        if (random() % 4 != 0) {
            frame.data[1] = static_cast<std::uint8_t>(0x10U | (frame.data[1] & 15U));
            frame.data[2] = kActions[random() % 4];
            frame.data[3] = kSteps[random() % 4];
            frame.data[4] = static_cast<std::uint8_t>(random() % 3);
            frame.data[0] =
                classical_crc(std::span<const std::uint8_t, 8>(frame.data.data(), 8), 0x584);
        }
        if (random() % 16 == 0) {
            frame.data[random() % 8] ^= static_cast<std::uint8_t>(1U << random() % 8);
        }
        axg_board_can_frame same{};
        same.id = frame.id;
        same.length = frame.length_bytes;
        std::copy_n(frame.data.begin(), 8, same.data);
        axg_operator_message theirs{};
        OperatorMessage ours;
        const bool is_theirs = axg_operator_decode(&same, test::kOperatorIn, &theirs);
        ASSERT_EQ(decode_operator_message(kUsualLayout, frame, ours) == FrameStatus::ok, is_theirs)
            << i;
        if (is_theirs) {
            ++taken;
            ASSERT_EQ(static_cast<int>(ours.action), static_cast<int>(theirs.action));
            ASSERT_EQ(static_cast<int>(ours.step), static_cast<int>(theirs.step));
            ASSERT_EQ(ours.stands, theirs.stands);
            ASSERT_EQ(ours.counter, theirs.counter);
            ASSERT_EQ(ours.nonce, theirs.nonce);
        }
    }
    EXPECT_GT(taken, 10'000U);
}

TEST(OperatorFrames, WhatIsNotExactlyAMessageSaysHow) {
    test::OperatorPanel panel;
    const CanFrame good = panel.confirm(AXG_OPERATOR_ARM, 0x345678, 5);
    OperatorMessage message;
    ASSERT_EQ(decode_operator_message(kUsualLayout, good, message), FrameStatus::ok);
    const auto status_of_altered = [&](const auto& alter) {
        CanFrame altered = good;
        alter(altered);
        OperatorMessage untouched{.nonce = 1};
        const FrameStatus status = decode_operator_message(kUsualLayout, altered, untouched);
        EXPECT_EQ(untouched.nonce, 1U);
        return status;
    };
    using Frame = CanFrame&;
    EXPECT_EQ(status_of_altered([](Frame frame) { frame.id = 0x585; }), FrameStatus::not_ours);
    EXPECT_EQ(status_of_altered([](Frame frame) { frame.extended = true; }), FrameStatus::not_ours);
    EXPECT_EQ(status_of_altered([](Frame frame) { frame.remote = true; }), FrameStatus::not_ours);
    EXPECT_EQ(status_of_altered([](Frame frame) { frame.error = true; }), FrameStatus::not_ours);
    EXPECT_EQ(status_of_altered([](Frame frame) { frame.fd = true; }), FrameStatus::bad_format);
    EXPECT_EQ(status_of_altered([](Frame frame) { frame.raw_dlc = 9; }), FrameStatus::raw_dlc);
    EXPECT_EQ(status_of_altered([](Frame frame) { frame.length_bytes = 7; }),
              FrameStatus::bad_length);
    for (unsigned bit = 0; bit < 64; ++bit) {
        EXPECT_NE(status_of_altered([bit](Frame frame) {
                      frame.data[bit / 8] ^= static_cast<std::uint8_t>(1U << bit % 8);
                  }),
                  FrameStatus::ok)
            << bit;
    }
}

TEST(OperatorFrames, TheVectorsAreTheGuardsToo) {
    const auto vectors = test::Json::parse_file(AXG_SOURCE_DIR "/tests/vectors/permit2.json");
    int messages = 0, statuses = 0;
    for (const auto& script : vectors["scripts"]) {
        for (const auto& step : script["steps"]) {
            if (step["do"] == "status" && step["reads"] == 1) {
                ++statuses;
                const CanFrame made = encode_operator_status(
                    kUsualLayout,
                    {.phase = static_cast<GuardPhase>(step["phase"].get<int>()),
                     .action = static_cast<OperatorAction>(step["action"].get<int>()),
                     .refusal = static_cast<OperatorRefusal>(step["refusal"].get<int>()),
                     .counter = step["counter"].get<std::uint8_t>(),
                     .nonce = step["nonce"].get<std::uint32_t>()},
                    0);
                EXPECT_EQ(hex_of(made), step["want"].get<std::string>());
            } else if (step["do"] == "operator") {
                ++messages;
                CanFrame frame;
                frame.id = 0x584;
                frame.length_bytes = 8;
                const auto text = step["want"].get<std::string>();
                for (std::size_t i = 0; i < 8; ++i) {
                    frame.data[i] =
                        static_cast<std::uint8_t>(std::stoul(text.substr(2 * i, 2), nullptr, 16));
                }
                OperatorMessage read;
                const bool is_read =
                    decode_operator_message(kUsualLayout, frame, read) == FrameStatus::ok;
                EXPECT_EQ(is_read, step["reads"] == 1) << text;
                if (is_read) {
                    EXPECT_EQ(static_cast<int>(read.action), step["action"].get<int>());
                    EXPECT_EQ(static_cast<int>(read.step), step["step"].get<int>());
                    EXPECT_EQ(read.nonce, step["nonce"].get<std::uint32_t>());
                    EXPECT_TRUE(read.stands);
                    EXPECT_EQ(read.counter, step["counter"].get<unsigned>() & 15U);
                }
            }
        }
    }
    EXPECT_EQ(messages, 5);
    EXPECT_EQ(statuses, 2);
}

}  // namespace
}  // namespace axg
