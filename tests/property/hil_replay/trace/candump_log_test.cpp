// SPDX-License-Identifier: Apache-2.0
// What the writer writes the reader reads back, frame by frame; damaged lines are read or refused,
// never misread into frames that cannot exist. Prints the reader's speed. AXG_SEED repeats a run,
// AXG_RUNS lengthens it.
#include "hil_replay/trace/candump_log.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <iostream>
#include <random>

#include "hil_replay/trace/trace_base.hpp"
#include "tests/support/can_board.hpp"

namespace axg {
namespace {

using namespace test;

std::uint64_t seed() {
    static const std::uint64_t value = [] {
        const std::uint64_t chosen = environment_number("AXG_SEED", std::random_device{}());
        std::cout << "AXG_SEED=" << chosen << "\n";
        return chosen;
    }();
    return value;
}

CanFrame random_frame(std::mt19937_64& random, std::int64_t time_us) {
    constexpr std::uint8_t kLengths[16] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 12, 16, 20, 24, 32, 48, 64};
    CanFrame frame;
    frame.time_us = time_us;
    const auto kind = random() % 5;
    frame.error = kind == 0;
    frame.remote = kind == 1;
    frame.fd = kind == 2;
    frame.extended = !frame.error && random() % 2 == 0;
    frame.id = static_cast<std::uint32_t>(random()) &
               (frame.extended || frame.error ? 0x1FFFFFFFU : 0x7FFU);
    frame.length_bytes = frame.error ? std::uint8_t{8} : kLengths[random() % (frame.fd ? 16 : 9)];
    frame.bit_rate_switch = frame.fd && random() % 2 == 0;
    frame.error_state = frame.fd && random() % 2 == 0;
    frame.sent_by_host = random() % 2 == 0;
    for (std::size_t i = 0; i < frame.length_bytes && !frame.remote; ++i) {
        frame.data[i] = static_cast<std::uint8_t>(random());
    }
    return frame;
}

bool equal(const CanFrame& a, const CanFrame& b) {
    return a.time_us == b.time_us && a.id == b.id && a.extended == b.extended &&
           a.remote == b.remote && a.error == b.error && a.fd == b.fd &&
           a.bit_rate_switch == b.bit_rate_switch && a.error_state == b.error_state &&
           a.sent_by_host == b.sent_by_host && a.raw_dlc == b.raw_dlc &&
           a.length_bytes == b.length_bytes && a.data == b.data;
}

TEST(CandumpProperty, WhatIsWrittenIsReadBack) {
    std::mt19937_64 random(seed());
    std::string text;
    std::vector<CanFrame> frames;
    std::int64_t time_us = 0;
    for (std::uint64_t i = 0; i < environment_number("AXG_RUNS", 100'000); ++i) {
        time_us += static_cast<std::int64_t>(random() % 2'000'000);
        frames.push_back(random_frame(random, time_us));
        append_candump(text, frames.back(), "can0", true);
    }
    const auto reader = read_candump("t.log", text, {});
    CanFrame frame;
    for (const CanFrame& wanted : frames) {
        ASSERT_TRUE(reader->next(frame)) << reader->error();
        ASSERT_TRUE(equal(frame, wanted)) << "line " << reader->line();
    }
    EXPECT_FALSE(reader->next(frame));
    EXPECT_EQ(reader->error(), "");
}

TEST(CandumpProperty, DamagedLinesGivePossibleFramesOrARefusal) {
    std::mt19937_64 random(seed() + 1);
    constexpr char kAlphabet[] = "0123456789ABCDEFabcdefR#_.() T[]{}-\t\r\x01\xFF";
    std::uint64_t read = 0, refused = 0;
    for (std::uint64_t i = 0; i < environment_number("AXG_RUNS", 200'000); ++i) {
        std::string text;
        append_candump(text, random_frame(random, 1'000'000), "can0", true);
        for (std::uint64_t n = 1 + random() % 3; n > 0; --n) {
            const std::size_t at = random() % text.size();
            const char with = kAlphabet[random() % (sizeof kAlphabet - 1)];
            switch (random() % 3) {
                case 0:
                    text[at] = with;
                    break;
                case 1:
                    text.erase(at, 1);
                    break;
                default:
                    text.insert(at, 1, with);
            }
            if (text.empty()) {
                text.push_back('x');
            }
        }
        const auto reader = read_candump("t.log", text, {});
        CanFrame frame;
        while (reader->next(frame)) {
            ++read;
            ASSERT_LE(frame.id, frame.extended || frame.error ? 0x1FFFFFFFU : 0x7FFU) << text;
            ASSERT_TRUE(frame.fd ? is_fd_length(frame.length_bytes) : frame.length_bytes <= 8)
                << text;
            ASSERT_TRUE(frame.raw_dlc == 0 || (frame.raw_dlc >= 9 && frame.raw_dlc <= 15)) << text;
        }
        refused += reader->error().empty() ? 0 : 1;
    }
    std::cout << read << " read, " << refused << " refused\n";
    EXPECT_GT(read, 0U);
    EXPECT_GT(refused, 0U);
}

TEST(CandumpProperty, SpeedIsPrinted) {
    const Machine machine = five_axis_machine(CanFormat::classical);
    std::string text;
    std::uint64_t frames = 0;
    for (const auto& sample : board_frames(machine, 250'000)) {
        for (const CanFrame& frame : sample) {
            append_candump(text, frame, "can0");
            ++frames;
        }
    }
    const auto start = std::chrono::steady_clock::now();
    const auto reader = read_candump("t.log", text, {});
    CanFrame frame;
    std::uint64_t count = 0;
    while (reader->next(frame)) {
        ++count;
    }
    const std::chrono::duration<double> read_s = std::chrono::steady_clock::now() - start;
    EXPECT_EQ(count, frames);
    EXPECT_EQ(reader->error(), "");
    AxisReceiver receiver(machine);
    const auto again = read_candump("t.log", text, {});
    std::uint64_t snapshots = 0;
    const auto middle = std::chrono::steady_clock::now();
    while (again->next(frame)) {
        snapshots += receiver.on_frame(frame).kind == ReceiverEvent::Kind::snapshot ? 1 : 0;
    }
    const std::chrono::duration<double> all_s = std::chrono::steady_clock::now() - middle;
    EXPECT_EQ(snapshots, 250'000U);
    const auto rate = [&](double seconds) { return static_cast<double>(frames) / seconds / 1e6; };
    std::cout << "read: " << rate(read_s.count())
              << " million frames/s; read and received: " << rate(all_s.count())
              << " million frames/s\n";
}

}  // namespace
}  // namespace axg
