// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/protocol/axis_frames.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/finite.hpp"
#include "core/base/sincos.hpp"
#include "core/machine/can_id.hpp"
#include "firmware_if/protocol/e2e.hpp"
#include "firmware_if/protocol/permit_frames.hpp"
#include "firmware_if/protocol/signal_frames.hpp"
#include "firmware_if/protocol/wire.hpp"

namespace axg {
namespace {

using detail::get_little;
using detail::put_little;
using Wire = AxisFrameSet::AxisWire;

constexpr std::int64_t kTurnCounts = 3'600'000;  // 360 deg at 0.0001 deg
constexpr double kDegreesPerRadian = 180.0 / kPi;
constexpr double kRadiansPerDegree = kPi / 180.0;

/// Nearest count; false when not finite or beyond what a double counts exactly.
bool to_counts(double value, std::int64_t& counts) noexcept {
    if (!(std::abs(value) < 9.0e15)) {
        return false;
    }
    counts = std::llround(value);
    return true;
}

std::int64_t modulo_turn(std::int64_t counts) noexcept {
    const std::int64_t rest = counts % kTurnCounts;
    return rest < 0 ? rest + kTurnCounts : rest;
}

/// Counts of one axis in a field of `bits`; the most negative number is the marker and never a
/// position.
bool axis_counts(const WireFormat& wire, const Wire& axis, double position, unsigned bits,
                 std::int64_t& counts) noexcept {
    const double scaled = axis.kind == AxisKind::linear ? position * wire.counts_per_mm
                                                        : position * kDegreesPerRadian * 1.0e4;
    if (!to_counts(scaled, counts)) {
        return false;
    }
    if (axis.unlimited) {
        counts = modulo_turn(counts);
    }
    return std::abs(counts) < (std::int64_t{1} << (bits - 1U));
}

AxisFrameContent::Value axis_value(const WireFormat& wire, const Wire& axis, std::uint32_t index,
                                   std::int64_t raw, std::int64_t marker) noexcept {
    AxisFrameContent::Value value{index, raw, raw != marker, 0};
    if (!value.known) {
        return value;
    }
    if (axis.unlimited) {
        value.raw = raw = modulo_turn(raw);
    }
    const auto counts = static_cast<double>(raw);
    value.position = axis.kind == AxisKind::linear ? counts / wire.counts_per_mm
                                                   : counts / 1.0e4 * kRadiansPerDegree;
    return value;
}

/// One 24-bit slot of a classical set: axes in order, then the status, then nothing (which must be
/// 0).
FrameStatus decode_slot(const AxisFrameSet& set, std::uint32_t slot, const std::uint8_t* bytes,
                        AxisFrameContent& out) noexcept {
    if (slot < set.axis_count) {
        const std::int64_t raw = detail::sign_extend(get_little(bytes, 3), 24);
        out.values[out.value_count++] =
            axis_value(*set.wire, set.axes[slot], slot, raw, kNoPosition24);
        return FrameStatus::ok;
    }
    if (slot == set.axis_count) {
        out.has_status = out.has_tool = true;
        out.mode = bytes[0];
        out.tool = bytes[1];
        out.flags = bytes[2];
        return FrameStatus::ok;
    }
    return get_little(bytes, 3) == 0 ? FrameStatus::ok : FrameStatus::bad_format;
}

FrameStatus decode_classical(const AxisFrameSet& set, std::uint32_t index, const CanFrame& frame,
                             AxisFrameContent& out) noexcept {
    const std::span<const std::uint8_t, 8> bytes(frame.data.data(), 8);
    if (classical_crc(bytes, set.data_ids[index]) != bytes[0]) {
        return FrameStatus::bad_crc;
    }
    out.counter = bytes[1] & 0x0FU;
    out.sample_index = bytes[1] >> 4U;
    const FrameStatus first = decode_slot(set, 2 * index, bytes.data() + 2, out);
    const FrameStatus second = decode_slot(set, 2 * index + 1, bytes.data() + 5, out);
    return first != FrameStatus::ok ? first : second;
}

FrameStatus decode_fd(const AxisFrameSet& set, std::uint32_t /*index*/, const CanFrame& frame,
                      AxisFrameContent& out) noexcept {
    if (!p05_check({frame.data.data(), frame.length_bytes}, set.data_ids[0])) {
        return FrameStatus::bad_crc;
    }
    out.counter = frame.data[2];
    out.flags = frame.data[3];
    const std::uint8_t* at = frame.data.data() + 4;
    for (std::uint32_t i = 0; i < set.axis_count; ++i, at += 4) {
        const std::int64_t raw = detail::sign_extend(get_little(at, 4), 32);
        out.values[out.value_count++] = axis_value(*set.wire, set.axes[i], i, raw, kNoPosition32);
    }
    out.sender_time_us = static_cast<std::uint32_t>(get_little(at, 4));
    out.tool = static_cast<std::uint16_t>(get_little(at + 4, 2));
    out.mode = at[6];
    const std::uint8_t sync_counter = at[7];
    out.sample_index = static_cast<std::uint8_t>(sync_counter - 1U);
    out.has_status = out.has_tool = true;
    const auto* end = frame.data.data() + frame.length_bytes;
    const bool is_padded = std::all_of(at + 8, end, [](std::uint8_t byte) { return byte == 0; });
    const bool is_sample = sync_counter >= 1 && sync_counter <= kSyncCounterMax;
    return is_padded && is_sample ? FrameStatus::ok : FrameStatus::bad_format;
}

CanFrame blank_frame(const AxisFrameSet& set, std::uint32_t index) noexcept {
    CanFrame frame;
    frame.id = set.ids[index];
    frame.length_bytes = set.frame_bytes[index];
    frame.fd = set.is_flexible[index];
    frame.bit_rate_switch = frame.fd;
    return frame;
}

/// Writes all axis frames; returns the axis that does not fit, or kNoIndex.
std::uint32_t fill_classical(const AxisFrameSet& set, const AxisSnapshot& snapshot,
                             const AxisSnapshot& /*last*/, std::uint32_t counter,
                             std::span<CanFrame> out) noexcept {
    const auto sample_nibble = static_cast<std::uint8_t>(snapshot.sample % kSyncCounterMax & 15U);
    for (std::uint32_t index = 0; index < set.frame_count; ++index) {
        CanFrame frame = blank_frame(set, index);
        frame.data[1] = static_cast<std::uint8_t>((counter & 15U) | (sample_nibble << 4U));
        for (std::uint32_t half = 0; half < 2; ++half) {
            const std::uint32_t slot = 2 * index + half;
            std::uint8_t* bytes = frame.data.data() + 2 + 3 * half;
            if (slot < set.axis_count) {
                std::int64_t raw = 0;
                if (!axis_counts(*set.wire, set.axes[slot], snapshot.position[slot], 24, raw)) {
                    return slot;
                }
                put_little(bytes, static_cast<std::uint64_t>(raw), 3);
            } else if (slot == set.axis_count) {
                bytes[0] = snapshot.mode;
                bytes[1] = static_cast<std::uint8_t>(snapshot.tool & 0xFFU);
                bytes[2] = snapshot.flags;
            }
        }
        frame.data[0] = classical_crc(std::span<const std::uint8_t, 8>(frame.data.data(), 8),
                                      set.data_ids[index]);
        out[index] = frame;
    }
    return kNoIndex;
}

std::uint32_t fill_fd(const AxisFrameSet& set, const AxisSnapshot& snapshot,
                      const AxisSnapshot& /*last*/, std::uint32_t counter,
                      std::span<CanFrame> out) noexcept {
    CanFrame frame = blank_frame(set, 0);
    frame.data[3] = snapshot.flags;
    std::uint8_t* at = frame.data.data() + 4;
    for (std::uint32_t i = 0; i < set.axis_count; ++i, at += 4) {
        std::int64_t raw = 0;
        if (!axis_counts(*set.wire, set.axes[i], snapshot.position[i], 32, raw)) {
            return i;
        }
        put_little(at, static_cast<std::uint64_t>(raw), 4);
    }
    put_little(at, static_cast<std::uint64_t>(snapshot.latched_us), 4);
    put_little(at + 4, snapshot.tool, 2);
    at[6] = snapshot.mode;
    at[7] = sync_counter_of(snapshot.sample);
    p05_protect({frame.data.data(), frame.length_bytes}, set.data_ids[0],
                static_cast<std::uint8_t>(counter));
    out[0] = frame;
    return kNoIndex;
}

/// Returns the axis that does not fit, or kNoIndex.
std::uint32_t fill_look_ahead(const AxisFrameSet& set, const AxisSnapshot& snapshot,
                              const PathPoints& look_ahead, std::uint8_t counter,
                              CanFrame& out) noexcept {
    CanFrame frame;
    frame.id = set.look_ahead_id;
    frame.length_bytes = set.look_ahead_bytes;
    frame.fd = frame.bit_rate_switch = true;
    frame.data[3] = sync_counter_of(snapshot.sample);
    put_little(frame.data.data() + 4, set.look_ahead_samples, 2);
    std::uint8_t* at = frame.data.data() + 6;
    for (const auto* positions : {&look_ahead.position, &look_ahead.before}) {
        for (std::uint32_t i = 0; i < set.axis_count; ++i, at += 4) {
            std::int64_t raw = 0;
            if (!axis_counts(*set.wire, set.axes[i], (*positions)[i], 32, raw)) {
                return i;
            }
            put_little(at, static_cast<std::uint64_t>(raw), 4);
        }
    }
    p05_protect({frame.data.data(), frame.length_bytes}, set.look_ahead_data_id, counter);
    out = frame;
    return kNoIndex;
}

// In the order of kWireFormats.
constexpr std::array<AxisCodec, kWireFormats.size()> kCodecs{{
    {.decode = decode_classical, .fill = fill_classical, .counter_modulus = 16},
    {.decode = decode_fd,
     .fill = fill_fd,
     .counter_modulus = 256,
     .is_flexible = true,
     .bytes = 12,
     .bytes_an_axis = 4},
    {.decode = decode_signals, .fill = fill_signals},
    {.decode = decode_signals, .fill = fill_signals},
}};

}  // namespace

const AxisCodec& axis_codec(const WireFormat& wire) noexcept {
    return kCodecs[static_cast<std::size_t>(wire.format)];
}

std::uint32_t slot_of(const AxisFrameSet& set, const CanFrame& frame) noexcept {
    std::uint32_t slot = 0;
    for (; slot < set.frame_count; ++slot) {
        const SignalSelector& selector = set.selectors[slot];
        if (!is_id_of(set.ids[slot], frame.id, frame.extended)) {
            continue;
        }
        // A frame of another length has no valid selector; the decoder refuses it.
        if (selector.level_count == 0 || frame.length_bytes != set.frame_bytes[slot] ||
            detail::selects(selector, frame.data.data())) {
            break;
        }
    }
    return slot;
}

FrameStatus decode_axis_frame(const AxisFrameSet& set, std::uint32_t slot, const CanFrame& frame,
                              AxisFrameContent& out) noexcept {
    out = AxisFrameContent{};
    if (slot >= set.frame_count || !is_id_of(set.ids[slot], frame.id, frame.extended) ||
        frame.remote || frame.error) {
        return FrameStatus::not_ours;
    }
    if (frame.fd != set.is_flexible[slot]) {
        return FrameStatus::bad_format;
    }
    if (frame.raw_dlc != 0) {
        return FrameStatus::raw_dlc;
    }
    if (frame.length_bytes != set.frame_bytes[slot]) {
        return FrameStatus::bad_length;
    }
    return set.codec->decode(set, slot, frame, out);
}

FrameStatus decode_look_ahead_frame(const AxisFrameSet& set, const CanFrame& frame,
                                    LookAheadFrameContent& out) noexcept {
    out = LookAheadFrameContent{};
    if (set.look_ahead_samples == 0 || frame.id != set.look_ahead_id || frame.extended ||
        frame.remote || frame.error) {
        return FrameStatus::not_ours;
    }
    if (!frame.fd) {
        return FrameStatus::bad_format;
    }
    if (frame.length_bytes != set.look_ahead_bytes) {
        return FrameStatus::bad_length;
    }
    if (!p05_check({frame.data.data(), frame.length_bytes}, set.look_ahead_data_id)) {
        return FrameStatus::bad_crc;
    }
    out.counter = frame.data[2];
    out.sync_counter = frame.data[3];
    out.samples = static_cast<std::uint32_t>(get_little(frame.data.data() + 4, 2));
    const std::uint8_t* at = frame.data.data() + 6;
    bool is_good = out.sync_counter >= 1 && out.sync_counter <= kSyncCounterMax &&
                   out.samples == set.look_ahead_samples;
    for (auto* positions : {&out.position, &out.before}) {
        for (std::uint32_t i = 0; i < set.axis_count; ++i, at += 4) {
            const std::int64_t raw = detail::sign_extend(get_little(at, 4), 32);
            const auto value = axis_value(*set.wire, set.axes[i], i, raw, kNoPosition32);
            is_good = is_good && value.known;
            (*positions)[i] = value.position;
        }
    }
    const auto* end = frame.data.data() + frame.length_bytes;
    const bool is_padded = std::all_of(at, end, [](std::uint8_t byte) { return byte == 0; });
    return is_good && is_padded ? FrameStatus::ok : FrameStatus::bad_format;
}

CanFrame encode_sync(std::uint32_t id, std::uint8_t counter, std::int64_t time_us) noexcept {
    CanFrame frame;
    frame.id = id;
    frame.time_us = time_us;
    frame.length_bytes = 1;
    frame.data[0] = counter;
    return frame;
}

CanFrame encode_heartbeat(std::uint32_t id, std::uint8_t state, std::int64_t time_us) noexcept {
    return encode_sync(id, state, time_us);  // the same shape: one byte
}

std::int64_t bus_time_us(const CanFrame& frame, std::uint32_t bit_rate) noexcept {
    const std::int64_t length = frame.length_bytes;
    const std::int64_t us_at_1m = frame.fd ? 41 + 2 * length : 55 + 10 * length;
    return us_at_1m * 1'000'000 / std::max<std::int64_t>(1, bit_rate);
}

const char* to_text(EncodeStatus status) noexcept {
    switch (status) {
        case EncodeStatus::ok:
            return "ok";
        case EncodeStatus::bad_layout:
            return "the CAN layout does not fit the machine (format fd: at most 13 axes)";
        case EncodeStatus::bad_snapshot:
            return "the snapshot has another number of axes than the machine";
        case EncodeStatus::out_of_range:
            return "a position does not fit its field on the bus";
        case EncodeStatus::out_too_small:
            return "too little space for the frames";
    }
    return "unknown";
}

AxisEncoder::AxisEncoder(const Machine& machine, EncoderOptions options) noexcept
    : set_(make_frame_set(machine)), options_(options) {}

/// Due as on a board: at once, every 100 ms, and where SYNC begins again.
bool AxisEncoder::is_session_due(const AxisSnapshot& snapshot) const noexcept {
    return options_.says_session && set_.session_id != 0 &&
           (!has_session_ || sync_counter_of(snapshot.sample) == 1 ||
            snapshot.latched_us - session_us_ >= kSessionPeriodUs);
}

EncodeResult AxisEncoder::encode(const AxisSnapshot& snapshot, std::span<CanFrame> out,
                                 const PathPoints* look_ahead) noexcept {
    if (set_.axis_count == 0) {
        return {EncodeStatus::bad_layout};
    }
    if (snapshot.axis_count != set_.axis_count) {
        return {EncodeStatus::bad_snapshot};
    }
    if (out.size() < set_.frame_count + (set_.session_id != 0 ? 4U : 3U)) {
        return {EncodeStatus::out_too_small};
    }
    const std::uint32_t first = has_sync(*set_.wire) ? 1 : 0;  // SYNC goes before
    std::uint32_t misfit = set_.codec->fill(set_, snapshot, last_, counter_, out.subspan(first));
    std::uint32_t count = first + set_.frame_count;
    if (look_ahead != nullptr && set_.look_ahead_samples != 0 && misfit == kNoIndex) {
        misfit = fill_look_ahead(set_, snapshot, *look_ahead, static_cast<std::uint8_t>(counter_),
                                 out[count++]);
    }
    if (misfit != kNoIndex) {
        return {EncodeStatus::out_of_range, misfit};
    }
    if (first != 0) {
        const std::uint8_t most = set_.sync_counter_max;
        const std::uint8_t sync = most == 0 ? 0 : sync_counter_of(snapshot.sample, most);
        out[0] = encode_sync(set_.sync_id, sync, snapshot.latched_us);
        out[0].length_bytes = most == 0 ? 0 : 1;
    }
    if (is_native(*set_.wire) &&
        (!has_heartbeat_ || snapshot.latched_us - heartbeat_us_ >= kHeartbeatPeriodUs)) {
        out[count++] = encode_heartbeat(set_.heartbeat_id, kHeartbeatOperational, 0);
        heartbeat_us_ = snapshot.latched_us;
        has_heartbeat_ = true;
    }
    if (is_session_due(snapshot)) {
        out[count++] =
            encode_session(set_.session_id,
                           {.nonce = options_.nonce,
                            .lap = static_cast<std::uint16_t>(snapshot.sample / kSyncCounterMax),
                            .sync_counter = sync_counter_of(snapshot.sample),
                            .counter = session_counter_},
                           0);
        session_counter_ = static_cast<std::uint8_t>((session_counter_ + 1U) & 15U);
        session_us_ = snapshot.latched_us;
        has_session_ = true;
    }
    ++counter_;
    last_ = snapshot;
    std::int64_t total_us = 0;
    for (std::uint32_t i = first; i < count; ++i) {
        total_us += bus_time_us(out[i], options_.bit_rate) + options_.spacing_us;
        out[i].time_us = snapshot.latched_us + total_us;
    }
    const std::int64_t period_us = set_.sample_us;
    if (total_us >= period_us) {  // no such wire: a simulation at the paper's sample period
        for (std::uint32_t i = first; i < count; ++i) {
            out[i].time_us = snapshot.latched_us + period_us * (i + 1 - first) / (count + 1);
        }
    }
    return {EncodeStatus::ok, kNoIndex, count};
}

}  // namespace axg
