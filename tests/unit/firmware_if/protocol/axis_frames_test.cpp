// SPDX-License-Identifier: Apache-2.0
// The frames byte by byte, as docs/reference/protocol.md states them, and what the encoder refuses.
// Expected bytes are written out by hand from that page, never taken from the encoder.
#include "firmware_if/protocol/axis_frames.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "core/base/sincos.hpp"
#include "firmware_if/protocol/e2e.hpp"
#include "firmware_if/protocol/permit_frames.hpp"
#include "tests/support/frame_bytes.hpp"

namespace axg {
namespace {

using test::bytes_of;

Machine five_axes(CanFormat format) {
    Machine machine;
    for (const char* name : {"X", "Y", "Z", "A", "C"}) {
        Axis axis;
        axis.name = name;
        axis.kind = name[0] < 'D' ? AxisKind::rotary : AxisKind::linear;
        axis.unlimited = name[0] == 'C';
        axis.min = -1000;
        axis.max = 1000;
        machine.axes.push_back(axis);
    }
    machine.can.format = format;
    return machine;
}

AxisSnapshot sample_snapshot() {
    AxisSnapshot snapshot;
    snapshot.latched_us = 0x1'2345'6789;
    snapshot.sample = 19;  // SYNC counter 20, nibble 3
    snapshot.axis_count = 5;
    snapshot.tool = 0x0102;
    snapshot.mode = kModeMoving;
    snapshot.flags = 0x80;
    snapshot.position = {1.234, -0.002, -300.0, -90.0 * kPi / 180, -1.0 * kPi / 180};
    return snapshot;
}

using Bytes = std::vector<std::uint8_t>;

TEST(AxisEncoder, ClassicalFramesAreTheDocumentedBytes) {
    const Machine machine = five_axes(CanFormat::classical);
    AxisEncoder encoder(machine, {.says_session = false});
    std::array<CanFrame, kFramesPerSnapshotMax> out;
    const EncodeResult result = encoder.encode(sample_snapshot(), out);
    ASSERT_EQ(result.status, EncodeStatus::ok);
    ASSERT_EQ(result.frame_count, 5U);  // SYNC, three axis frames, the first heartbeat
    EXPECT_EQ(out[0].id, 0x080U);
    EXPECT_EQ(bytes_of(out[0]), Bytes{20});
    // counter 0, sample index 3; 1234 um = 0x0004D2, -2 um; -300000 um = 0xFB6C20, -900000 =
    // 0xF24460; C is endless: -1 deg is 359 deg = 3590000 = 0x36C770; mode 1, tool low byte 2,
    // flags 0x80
    const std::uint8_t payload[3][7] = {{0x30, 0xD2, 0x04, 0x00, 0xFE, 0xFF, 0xFF},
                                        {0x30, 0x20, 0x6C, 0xFB, 0x60, 0x44, 0xF2},
                                        {0x30, 0x70, 0xC7, 0x36, 0x01, 0x02, 0x80}};
    const std::uint8_t ids[3][2] = {{0x81, 0x01}, {0x81, 0x02}, {0x81, 0x03}};
    for (std::size_t i = 0; i < 3; ++i) {
        Bytes message(payload[i], payload[i] + 7);
        message.insert(message.end(), ids[i], ids[i] + 2);
        Bytes wanted{crc8_h2f(message)};
        wanted.insert(wanted.end(), payload[i], payload[i] + 7);
        EXPECT_EQ(out[1 + i].id, 0x181U + 0x100U * i);
        EXPECT_FALSE(out[1 + i].fd);
        EXPECT_EQ(bytes_of(out[1 + i]), wanted) << i;
    }
    EXPECT_EQ(out[4].id, 0x701U);
    EXPECT_EQ(bytes_of(out[4]), Bytes{5});
}

TEST(AxisEncoder, FdFrameIsTheDocumentedBytes) {
    const Machine machine = five_axes(CanFormat::fd);
    AxisEncoder encoder(machine);
    std::array<CanFrame, kFramesPerSnapshotMax> out;
    ASSERT_EQ(encoder.encode(sample_snapshot(), out).status, EncodeStatus::ok);
    const Bytes got = bytes_of(out[1]);
    ASSERT_EQ(got.size(), 32U);
    EXPECT_TRUE(out[1].fd && out[1].bit_rate_switch);
    // flags; 12340, -20, -3000000 (0.1 um), -900000, 3590000 (0.0001 deg); time; tool; mode; SYNC
    // counter
    const Bytes payload{0x00, 0x80, 0x34, 0x30, 0x00, 0x00, 0xEC, 0xFF, 0xFF, 0xFF,
                        0x40, 0x39, 0xD2, 0xFF, 0x60, 0x44, 0xF2, 0xFF, 0x70, 0xC7,
                        0x36, 0x00, 0x89, 0x67, 0x45, 0x23, 0x02, 0x01, 0x01, 20};
    EXPECT_EQ(Bytes(got.begin() + 2, got.end()), payload);
    Bytes message = payload;
    message.insert(message.end(), {0x81, 0x01});
    const std::uint16_t crc = crc16_ccitt(message);
    EXPECT_EQ(got[0], crc & 0xFF);
    EXPECT_EQ(got[1], crc >> 8);
}

TEST(AxisEncoder, TimesOnTheBusAreThoseOfTheWire) {
    const Machine machine = five_axes(CanFormat::classical);
    AxisEncoder encoder(machine, {.says_session = false});
    std::array<CanFrame, kFramesPerSnapshotMax> out;
    AxisSnapshot snapshot = sample_snapshot();
    snapshot.latched_us = 1000;
    ASSERT_EQ(encoder.encode(snapshot, out).frame_count, 5U);
    EXPECT_EQ(out[0].time_us, 1000);  // positions are latched as SYNC ends
    EXPECT_EQ(out[1].time_us, 1135);
    EXPECT_EQ(out[3].time_us, 1405);
    EXPECT_EQ(out[4].time_us, 1470);
}

TEST(AxisEncoder, ASampleTooShortForAnyWireStillEndsBeforeTheNext) {
    Machine machine = five_axes(CanFormat::classical);
    machine.can.sample_us = 100;
    AxisEncoder encoder(machine);
    std::array<CanFrame, kFramesPerSnapshotMax> out;
    AxisSnapshot snapshot = sample_snapshot();
    snapshot.latched_us = 0;
    const std::uint32_t count = encoder.encode(snapshot, out).frame_count;
    for (std::uint32_t i = 1; i < count; ++i) {
        EXPECT_GT(out[i].time_us, out[i - 1].time_us);
        EXPECT_LT(out[i].time_us, 100);
    }
}

TEST(AxisEncoder, HeartbeatComesEveryTenMilliseconds) {
    const Machine machine = five_axes(CanFormat::fd);
    AxisEncoder encoder(machine, {.says_session = false});
    std::array<CanFrame, kFramesPerSnapshotMax> out;
    AxisSnapshot snapshot = sample_snapshot();
    int heartbeats = 0;
    for (int k = 0; k < 100; ++k) {
        snapshot.latched_us = 1000 * k;
        snapshot.sample = static_cast<std::uint64_t>(k);
        heartbeats += encoder.encode(snapshot, out).frame_count == 3 ? 1 : 0;
    }
    EXPECT_EQ(heartbeats, 10);
}

TEST(AxisEncoder, RefusesWhatDoesNotFitOnBothSidesOfTheBound) {
    struct Case {
        CanFormat format;
        double fits_mm, too_much_mm;
    };
    for (const Case& c : {Case{CanFormat::classical, 8388.607, 8388.608},
                          Case{CanFormat::fd, 214748.3647, 214748.3648}}) {
        const Machine machine = five_axes(c.format);
        AxisEncoder encoder(machine);
        std::array<CanFrame, kFramesPerSnapshotMax> out;
        AxisSnapshot snapshot = sample_snapshot();
        for (const double sign : {1.0, -1.0}) {
            snapshot.position[2] = sign * c.fits_mm;
            EXPECT_EQ(encoder.encode(snapshot, out).status, EncodeStatus::ok);
            snapshot.position[2] = sign * c.too_much_mm;
            const EncodeResult result = encoder.encode(snapshot, out);
            EXPECT_EQ(result.status, EncodeStatus::out_of_range);
            EXPECT_EQ(result.axis, 2U);
            EXPECT_EQ(result.frame_count, 0U);
        }
        snapshot.position[2] = std::nan("");
        EXPECT_EQ(encoder.encode(snapshot, out).status, EncodeStatus::out_of_range);
        snapshot.position[2] = 0;
        snapshot.axis_count = 4;
        EXPECT_EQ(encoder.encode(snapshot, out).status, EncodeStatus::bad_snapshot);
        snapshot.axis_count = 5;
        EXPECT_EQ(encoder.encode(snapshot, std::span(out).first(2)).status,
                  EncodeStatus::out_too_small);
    }
}

TEST(DecodeAxisFrame, TheMarkerIsNoPosition) {
    const Machine machine = five_axes(CanFormat::classical);
    const AxisFrameSet set = make_frame_set(machine);
    CanFrame frame;
    frame.id = 0x181;
    frame.length_bytes = 8;
    frame.data = {0, 0x00, 0x00, 0x00, 0x80, 0x01, 0x00, 0x80};
    frame.data[0] = classical_crc(std::span<const std::uint8_t, 8>(frame.data.data(), 8), 0x0181);
    AxisFrameContent content;
    ASSERT_EQ(decode_axis_frame(set, 0, frame, content), FrameStatus::ok);
    EXPECT_FALSE(content.values[0].known);
    EXPECT_TRUE(content.values[1].known);  // one count above the marker is a position
    EXPECT_DOUBLE_EQ(content.values[1].position, -8388.607);
}

TEST(DecodeAxisFrame, RefusesEveryWrongFormat) {
    const Machine machine = five_axes(CanFormat::classical);
    AxisEncoder encoder(machine);
    std::array<CanFrame, kFramesPerSnapshotMax> out;
    ASSERT_EQ(encoder.encode(sample_snapshot(), out).status, EncodeStatus::ok);
    const AxisFrameSet& set = encoder.frame_set();
    AxisFrameContent content;
    const CanFrame good = out[1];
    ASSERT_EQ(decode_axis_frame(set, 0, good, content), FrameStatus::ok);
    const auto judge = [&](auto change) {
        CanFrame frame = good;
        change(frame);
        return decode_axis_frame(set, 0, frame, content);
    };
    EXPECT_EQ(judge([](CanFrame& f) { f.extended = true; }), FrameStatus::not_ours);
    EXPECT_EQ(judge([](CanFrame& f) { f.remote = true; }), FrameStatus::not_ours);
    EXPECT_EQ(judge([](CanFrame& f) { f.error = true; }), FrameStatus::not_ours);
    EXPECT_EQ(judge([](CanFrame& f) { f.fd = true; }), FrameStatus::bad_format);
    EXPECT_EQ(judge([](CanFrame& f) { f.length_bytes = 7; }), FrameStatus::bad_length);
    EXPECT_EQ(judge([](CanFrame& f) { f.length_bytes = 0; }), FrameStatus::bad_length);
    EXPECT_EQ(judge([](CanFrame& f) { f.raw_dlc = 9; }), FrameStatus::raw_dlc);
    EXPECT_EQ(judge([](CanFrame& f) { f.data[5] ^= 1; }), FrameStatus::bad_crc);
    CanFrame masked = out[2];  // the right payload under another frame's id
    masked.id = 0x181;
    EXPECT_EQ(decode_axis_frame(set, 0, masked, content), FrameStatus::bad_crc);
}

// Whoever plays a board of permit 2 says its session too: at once, every 100 ms, with each lap.
TEST(AxisEncoder, SaysTheSessionOfABoardOfPermitTwo) {
    for (const CanFormat format : {CanFormat::classical, CanFormat::fd}) {
        Machine machine = five_axes(format);
        AxisEncoder encoder(machine);
        std::vector<std::uint64_t> said;
        for (std::uint64_t k = 0; k < 600; ++k) {
            AxisSnapshot snapshot;
            snapshot.axis_count = 5;
            snapshot.sample = k;
            snapshot.latched_us = 1'000'000 + 1000 * static_cast<std::int64_t>(k);
            std::array<CanFrame, kFramesPerSnapshotMax> frames{};
            const EncodeResult result = encoder.encode(snapshot, frames);
            ASSERT_EQ(result.status, EncodeStatus::ok);
            const CanFrame& last = frames[result.frame_count - 1];
            Session session;
            if (decode_session(0x583, last, session) == FrameStatus::ok) {
                EXPECT_EQ(session.lap, k / 240);
                EXPECT_EQ(session.sync_counter, sync_counter_of(k));
                EXPECT_EQ(session.counter, said.size());
                EXPECT_GT(last.time_us, snapshot.latched_us);
                said.push_back(k);
            }
        }
        EXPECT_EQ(said, (std::vector<std::uint64_t>{0, 100, 200, 240, 340, 440, 480, 580}));
    }
}

TEST(FrameSet, IsEmptyWithoutAnIdOfEachFrame) {
    Machine machine = five_axes(CanFormat::classical);
    machine.axes.push_back(machine.axes[0]);  // 6 axes and the status: four frames
    EXPECT_EQ(make_frame_set(machine).axis_count, 0U);
    machine.can.axis_ids.push_back(0x481);
    EXPECT_EQ(make_frame_set(machine).axis_count, 0U) << "a data id is missing";
    machine.can.data_ids.push_back(0x0481);
    EXPECT_EQ(make_frame_set(machine).frame_count, 4U);
}

// A board with a sample counter sends its session.
TEST(FrameSet, HasTheSessionOfABoard) {
    EXPECT_EQ(make_frame_set(five_axes(CanFormat::classical)).session_id, 0x583U);
    EXPECT_EQ(make_frame_set(five_axes(CanFormat::signals)).session_id, 0U);
}

TEST(FrameSet, OfFdHoldsThirteenAxesAndNoMore) {
    Machine machine = five_axes(CanFormat::fd);
    machine.axes.resize(13, machine.axes[0]);
    EXPECT_EQ(make_frame_set(machine).frame_bytes[0], 64);
    machine.axes.resize(14, machine.axes[0]);
    EXPECT_EQ(make_frame_set(machine).axis_count, 0U);
    machine.axes.clear();
    EXPECT_EQ(make_frame_set(machine).axis_count, 0U);
}

CanSignal signal(std::uint32_t axis, std::uint16_t start, std::uint8_t length, ByteOrder order) {
    CanSignal s;
    s.id = 0x200;
    s.axis = axis;
    s.start_bit = start;
    s.length_bits = length;
    s.order = order;
    return s;
}

TEST(Signals, BothByteOrdersLieWhereADbcPutsThem) {
    Machine machine = five_axes(CanFormat::signals);
    machine.axes.resize(2, machine.axes[0]);
    machine.can.signals = {signal(0, 4, 12, ByteOrder::little), signal(1, 19, 12, ByteOrder::big)};
    AxisEncoder encoder(machine);
    std::array<CanFrame, kFramesPerSnapshotMax> out;
    AxisSnapshot snapshot;
    snapshot.axis_count = 2;
    snapshot.position = {0x123, 0x456};
    ASSERT_EQ(encoder.encode(snapshot, out).frame_count, 1U);
    // little: bits 4..15 hold 0x123. big: from bit 3 of byte 2 downwards, 4 bits, then all of byte
    // 3
    EXPECT_EQ(bytes_of(out[0]), (Bytes{0x30, 0x12, 0x04, 0x56, 0, 0, 0, 0}));
    snapshot.position = {-1, -2048};
    ASSERT_EQ(encoder.encode(snapshot, out).status, EncodeStatus::ok);
    EXPECT_EQ(bytes_of(out[0]), (Bytes{0xF0, 0xFF, 0x08, 0x00, 0, 0, 0, 0}));
    snapshot.position = {0, -2049};
    EXPECT_EQ(encoder.encode(snapshot, out).status, EncodeStatus::out_of_range);
    snapshot.position = {2048, 0};
    EXPECT_EQ(encoder.encode(snapshot, out).status, EncodeStatus::out_of_range);
}

// A machine file has no such signals; these lead outside an array.
TEST(Signals, WithoutAPlaceForEachTheSetIsEmpty) {
    Machine machine = five_axes(CanFormat::signals);
    machine.axes.resize(1);
    const auto fits = [&](std::vector<CanSignal> signals) {
        machine.can.signals = std::move(signals);
        return make_frame_set(machine).axis_count != 0;
    };
    EXPECT_TRUE(fits({signal(0, 32, 32, ByteOrder::little)}));
    EXPECT_FALSE(fits({signal(0, 33, 32, ByteOrder::little)}));
    EXPECT_TRUE(fits({signal(0, 39, 32, ByteOrder::big)}));
    EXPECT_FALSE(fits({signal(0, 38, 32, ByteOrder::big)}));
    EXPECT_FALSE(fits({signal(0, 0, 0, ByteOrder::little)}));
    EXPECT_TRUE(fits({signal(0, 0, 53, ByteOrder::little)}));
    EXPECT_FALSE(fits({signal(0, 0, 54, ByteOrder::little)}));
    EXPECT_FALSE(fits({signal(1, 0, 8, ByteOrder::little)}));
    CanSignal paged = signal(0, 0, 8, ByteOrder::little);
    const auto fits_level = [&](SignalSelector::Level level, std::uint8_t count) {
        paged.selector = {.level_count = count};
        paged.selector.levels.fill(level);
        return fits({paged});
    };
    EXPECT_TRUE(fits_level({32, 32, ByteOrder::little, 8}, 1));
    EXPECT_FALSE(fits_level({33, 32, ByteOrder::little, 8}, 1));
    EXPECT_FALSE(fits_level({0, 33, ByteOrder::little, 8}, 1));
    EXPECT_FALSE(fits_level({0, 8, ByteOrder::little, 0}, 1)) << "no value";
    EXPECT_FALSE(fits_level({0, 8, ByteOrder::little, 9}, 1)) << "more than there is room for";
    EXPECT_TRUE(fits_level({0, 8, ByteOrder::little, 2}, 3));
    EXPECT_FALSE(fits_level({0, 8, ByteOrder::little, 3}, 3)) << "all together";
    EXPECT_FALSE(fits_level({0, 8, ByteOrder::little, 1}, 4));
    EXPECT_FALSE(fits({signal(0, 0, 8, ByteOrder::little), signal(0, 8, 8, ByteOrder::little)}))
        << "two positions of one axis";
    machine.axes.resize(2, machine.axes[0]);
    EXPECT_FALSE(fits({signal(0, 0, 8, ByteOrder::little), signal(0, 8, 8, ByteOrder::little)}))
        << "and none of the other";
    machine.axes.resize(1);
    EXPECT_FALSE(fits({}));
    std::vector<CanSignal> many(kAxisFramesMax, signal(0, 0, 8, ByteOrder::little));
    for (std::uint32_t i = 0; i < kAxisFramesMax; ++i) {
        many[i].id += i;
        many[i].role = i == 0 ? SignalRole::position : SignalRole::velocity;
    }
    EXPECT_TRUE(fits(many));
    many.push_back(many.back());
    EXPECT_TRUE(fits(many)) << "in a frame of another";
    many.back().id += 1;
    EXPECT_FALSE(fits(many));
    many.assign(kSignalsMax + 1, many[1]);
    many[0].role = SignalRole::position;
    EXPECT_FALSE(fits(many));
}

}  // namespace
}  // namespace axg
