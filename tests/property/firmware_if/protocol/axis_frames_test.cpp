// SPDX-License-Identifier: Apache-2.0
// Random machines and positions survive the wire to half a count; random payloads pass the
// checksums no more often than chance; a receiver on a bad bus hands out only what the board sent.
// AXG_SEED repeats a run, AXG_RUNS lengthens it.
#include "firmware_if/protocol/axis_frames.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <iostream>
#include <random>

#include "firmware_if/protocol/wire.hpp"
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
std::uint64_t runs(std::uint64_t otherwise) {
    return environment_number("AXG_RUNS", otherwise);
}

double uniform(std::mt19937_64& random, double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
}
std::uint32_t below(std::mt19937_64& random, std::uint32_t end) {
    return std::uniform_int_distribution<std::uint32_t>(0, end - 1)(random);
}

/// Eight random bytes into the payload from byte `at` on.
void fill_eight(CanFrame& frame, std::size_t at, std::uint64_t bits) {
    detail::put_little(frame.data.data() + at, bits, 8);
}

Machine random_machine(std::mt19937_64& random) {
    Machine machine;
    const auto format = static_cast<CanFormat>(below(random, 3));
    machine.can.format = format;
    const std::uint32_t count = 1 + below(random, format == CanFormat::fd ? 13 : 16);
    for (std::uint32_t i = 0; i < count; ++i) {
        Axis axis;
        axis.kind = static_cast<AxisKind>(below(random, 2));
        axis.unlimited = axis.kind == AxisKind::rotary && below(random, 2) == 0;
        machine.axes.push_back(axis);
        CanSignal signal;
        signal.id = 0x300 + i / 2;
        signal.axis = i;
        signal.length_bits = static_cast<std::uint8_t>(28 + below(random, 5));
        signal.order = static_cast<ByteOrder>(below(random, 2));
        const std::uint32_t first = i % 2 * 32 + below(random, 33U - signal.length_bits);
        signal.start_bit = static_cast<std::uint16_t>(
            signal.order == ByteOrder::little ? first : first / 8 * 8 + 7 - first % 8);
        signal.factor = uniform(random, 1.0e-4, 1.0e-3) * (below(random, 2) == 0 ? 1 : -1);
        signal.offset = uniform(random, -50, 50);
        machine.can.signals.push_back(signal);
    }
    machine.can.axis_ids.clear();
    machine.can.data_ids.clear();
    for (std::uint32_t i = 0; i < 9; ++i) {
        machine.can.axis_ids.push_back(0x200 + i);
        machine.can.data_ids.push_back(static_cast<std::uint16_t>(random()));
    }
    return machine;
}

TEST(AxisFramesProperty, EveryPositionSurvivesTheWireToHalfACount) {
    std::mt19937_64 random(seed());
    for (std::uint64_t run = 0; run < runs(20'000); ++run) {
        const Machine machine = random_machine(random);
        AxisEncoder encoder(machine);
        const AxisFrameSet& set = encoder.frame_set();
        ASSERT_EQ(set.axis_count, machine.axes.size());
        AxisSnapshot snapshot;
        snapshot.axis_count = set.axis_count;
        snapshot.sample = random() % 100'000;
        snapshot.tool = static_cast<std::uint16_t>(random());
        snapshot.mode = static_cast<std::uint8_t>(random());
        snapshot.flags = static_cast<std::uint8_t>(random());
        for (std::uint32_t i = 0; i < set.axis_count; ++i) {
            const bool linear = machine.axes[i].kind == AxisKind::linear;
            const double limit = machine.axes[i].unlimited ? 1.0e4 : linear ? 8000 : 14;
            const double reach =
                machine.can.format == CanFormat::signals && !linear && !machine.axes[i].unlimited
                    ? 6
                    : limit;
            snapshot.position[i] = uniform(random, -reach, reach);
        }
        std::array<CanFrame, kFramesPerSnapshotMax> out;
        const EncodeResult result = encoder.encode(snapshot, out);
        ASSERT_EQ(result.status, EncodeStatus::ok) << to_text(result.status) << result.axis;
        const std::uint32_t first = machine.can.format == CanFormat::signals ? 0 : 1;
        std::uint32_t seen = 0;
        for (std::uint32_t slot = 0; slot < set.frame_count; ++slot) {
            AxisFrameContent content;
            ASSERT_EQ(decode_axis_frame(set, slot, out[first + slot], content), FrameStatus::ok);
            for (std::uint32_t v = 0; v < content.value_count; ++v, ++seen) {
                const auto& value = content.values[v];
                double off = value.position - snapshot.position[value.axis];
                if (machine.axes[value.axis].unlimited) {
                    off -= 2 * kPi * std::round(off / (2 * kPi));
                    EXPECT_GE(value.position, 0);
                    EXPECT_LE(value.position, 2 * kPi);
                }
                ASSERT_LE(std::abs(off), 0.5 * set.axes[value.axis].unit + 1.0e-9);
            }
            if (content.has_status) {
                EXPECT_EQ(content.mode, snapshot.mode);
                EXPECT_EQ(content.flags, snapshot.flags);
            }
        }
        ASSERT_EQ(seen, set.axis_count);
    }
}

/// Random payloads under the right id, format and length.
std::uint64_t accepted_of(CanFormat format, std::uint64_t count, std::mt19937_64& random) {
    const Machine machine = five_axis_machine(format);
    const AxisFrameSet set = make_frame_set(machine);
    CanFrame frame;
    frame.id = set.ids[0];
    frame.fd = format == CanFormat::fd;
    frame.length_bytes = set.frame_bytes[0];
    AxisFrameContent content;
    std::uint64_t accepted = 0;
    for (std::uint64_t i = 0; i < count; ++i) {
        for (std::size_t b = 0; b < frame.length_bytes; b += 8) {
            fill_eight(frame, b, random());
        }
        accepted += decode_axis_frame(set, 0, frame, content) == FrameStatus::ok ? 1 : 0;
    }
    return accepted;
}

TEST(AxisFramesProperty, C11_RandomPayloadsPassNoMoreOftenThanChance) {
    std::mt19937_64 random(seed() + 1);
    const std::uint64_t count = runs(1'000'000);
    const auto bound = [&](double chance) {
        const double mean = static_cast<double>(count) * chance;
        return mean + 6 * std::sqrt(mean) + 6;
    };
    const auto classical = static_cast<double>(accepted_of(CanFormat::classical, count, random));
    const auto fd = static_cast<double>(accepted_of(CanFormat::fd, count, random));
    EXPECT_LE(classical, bound(1.0 / 256));
    EXPECT_LE(fd, bound(1.0 / 65536));
    EXPECT_GE(classical, static_cast<double>(count) / 256 / 2);  // the test does reach the CRC
}

/// True if this is sample `snapshot.sample` of the board's path, to half a count and a rounding.
bool was_sent(const Machine& machine, const AxisFrameSet& set, const AxisSnapshot& snapshot) {
    const AxisSnapshot sent = snapshot_at(machine, snapshot.sample);
    for (std::uint32_t i = 0; i < 5; ++i) {
        double off = snapshot.position[i] - sent.position[i];
        if (machine.axes[i].unlimited) {
            off -= 2 * kPi * std::round(off / (2 * kPi));
        }
        if (std::abs(off) > 0.51 * set.axes[i].unit) {
            return false;
        }
    }
    // A SYNC held up in the queue can hide a fifth of a period, its tolerance, and a little of its
    // drift.
    return snapshot.latched_us <= sent.latched_us + machine.can.sample_us / 4;
}

void damage(std::vector<CanFrame>& frames, const std::vector<CanFrame>& older,
            std::mt19937_64& random) {
    const std::size_t at = below(random, static_cast<std::uint32_t>(frames.size()));
    CanFrame& frame = frames[at];
    switch (below(random, 9)) {
        case 0:
            frames.erase(frames.begin() + static_cast<std::ptrdiff_t>(at));
            break;
        case 1:
            frames.insert(frames.begin() + static_cast<std::ptrdiff_t>(at), frame);
            break;
        case 2:
            frame.data[below(random, 8)] ^= static_cast<std::uint8_t>(1 + below(random, 255));
            break;
        case 3:
            frame.length_bytes = static_cast<std::uint8_t>(below(random, 9));
            break;
        case 4:
            frame.extended = true;
            break;
        case 5:
            std::swap(frames[0], frame);
            break;
        case 6:
            fill_eight(frame, 0, random());
            break;
        case 7:
            frames.push_back(older[below(random, static_cast<std::uint32_t>(older.size()))]);
            break;
        default:
            std::swap(frame.data,
                      frames[below(random, static_cast<std::uint32_t>(frames.size()))].data);
    }
}

TEST(AxisReceiverProperty, OnABadBusEverySnapshotIsOneTheBoardSent) {
    std::mt19937_64 random(seed() + 2);
    std::uint64_t snapshots = 0, stops = 0;
    for (std::uint64_t run = 0; run < runs(300); ++run) {
        const CanFormat format = run % 2 == 0 ? CanFormat::classical : CanFormat::fd;
        const Machine machine = five_axis_machine(format);
        auto samples = board_frames(machine, 300);
        AxisReceiver receiver(machine);
        const AxisFrameSet set = make_frame_set(machine);
        Heard heard;
        for (std::size_t k = 0; k < samples.size(); ++k) {
            if (k > 3 && below(random, 8) == 0) {
                damage(samples[k], samples[k - 1 - below(random, 3)], random);
            }
            std::int64_t now_us = 0;  // a queue keeps order: stamps never run backwards
            for (CanFrame& frame : samples[k]) {
                frame.time_us = now_us = std::max(now_us, frame.time_us);
            }
            listen(receiver, samples[k], heard);
            if (receiver.state() == ReceiverState::invalid) {
                break;
            }
        }
        stops += receiver.state() == ReceiverState::invalid ? 1 : 0;
        snapshots += heard.snapshots.size();
        for (const AxisSnapshot& snapshot : heard.snapshots) {
            ASSERT_TRUE(was_sent(machine, set, snapshot))
                << "run " << run << " sample " << snapshot.sample << " latched "
                << snapshot.latched_us - snapshot_at(machine, snapshot.sample).latched_us
                << " us after the board did, X off by "
                << snapshot.position[0] - snapshot_at(machine, snapshot.sample).position[0]
                << " mm";
        }
    }
    std::cout << snapshots << " pictures, " << stops << " stops\n";
    EXPECT_GT(snapshots, 1000U);
}

}  // namespace
}  // namespace axg
