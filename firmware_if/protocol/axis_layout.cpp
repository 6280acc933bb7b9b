// SPDX-License-Identifier: Apache-2.0
// From the machine's layout to fixed arrays.
#include <algorithm>
#include <cmath>

#include "core/base/sincos.hpp"
#include "firmware_if/protocol/axis_frames.hpp"
#include "firmware_if/protocol/obeyed_by.hpp"
#include "firmware_if/protocol/wire.hpp"

namespace axg {
namespace {

/// FD payloads have these lengths only; 0 if `bytes` is beyond the last.
constexpr std::uint8_t fd_length(std::uint32_t bytes) noexcept {
    constexpr std::uint8_t kLengths[] = {8, 12, 16, 20, 24, 32, 48, 64};
    for (const std::uint8_t length : kLengths) {
        if (bytes <= length) {
            return length;
        }
    }
    return 0;
}

constexpr std::uint8_t frame_bytes_of(const CanLayout& can, const CanSignal& signal) noexcept {
    return signal.frame_bytes != 0 ? signal.frame_bytes : can.signal_frame_bytes;
}

/// Bit positions of a big-endian run go down a byte and on at the top of the next one.
bool is_inside(const detail::BitRun& run, std::uint32_t frame_bytes) noexcept {
    const std::uint32_t first = run.order == ByteOrder::little
                                    ? run.start_bit
                                    : run.start_bit / 8U * 8U + 7U - run.start_bit % 8U;
    return first + run.length_bits <= frame_bytes * 8U;
}

bool fits_frame(const SignalSelector& selector, std::uint8_t bytes) noexcept {
    constexpr std::uint8_t kSelectorBitsMax = 32;
    std::uint32_t ranges = 0;
    for (std::uint32_t i = 0; i < selector.level_count; ++i) {
        if (i >= kSelectorLevelsMax || selector.levels[i].range_count == 0 ||
            selector.levels[i].length_bits > kSelectorBitsMax ||
            !is_inside(detail::bits_of(selector.levels[i]), bytes)) {
            return false;
        }
        ranges += selector.levels[i].range_count;
    }
    return ranges <= kSelectorRangesMax;
}

bool fits_frame(const CanLayout& can, const CanSignal& signal) noexcept {
    constexpr std::uint8_t kExactBitsMax = 53;
    const std::uint8_t bytes = frame_bytes_of(can, signal);
    const std::uint8_t most = signal.type == SignalType::integer ? kExactBitsMax : 64;
    return bytes <= 64 && signal.length_bits >= 1 && signal.length_bits <= most &&
           is_inside(detail::bits_of(signal), bytes) && fits_frame(signal.selector, bytes);
}

/// Whether the arrays of a set hold the layout. The reader of machine files (config/can) checks
/// the rules of a layout. This covers machines without a file: no index leaves an array.
bool fits_set(const Machine& machine) noexcept {
    const CanLayout& can = machine.can;
    const std::size_t axes = machine.axes.size();
    if (axes == 0 || axes > kAxesMax || can.sample_us == 0) {
        return false;
    }
    if (is_native(can)) {
        const WireFormat& wire = wire_of(can);
        const std::size_t frames = own_axis_frames(wire, axes);
        const bool has_room = can.look_ahead_samples != 0
                                  ? wire.has_look_ahead && axes <= kLookAheadAxesMax
                                  : axes <= wire.axes_max;
        return has_room && can.look_ahead_samples <= kLookAheadSamplesMax &&
               can.axis_ids.size() >= frames && can.data_ids.size() >= frames;
    }
    if (can.signals.size() > kSignalsMax || signal_frames(can.signals) > kAxisFramesMax) {
        return false;
    }
    std::array<std::uint32_t, kAxesMax> positions{};
    for (const CanSignal& signal : can.signals) {
        if (signal.axis >= axes || !fits_frame(can, signal)) {
            return false;
        }
        positions[signal.axis] += signal.role == SignalRole::position ? 1 : 0;
    }
    return std::all_of(positions.begin(), positions.begin() + axes,
                       [](std::uint32_t count) { return count == 1; });
}

std::uint32_t slot_for(const CanSignal& signal, const CanLayout& can, AxisFrameSet& set) noexcept {
    std::uint32_t slot = 0;
    while (slot < set.frame_count &&
           (set.ids[slot] != signal.id || set.selectors[slot] != signal.selector)) {
        ++slot;
    }
    if (slot == set.frame_count) {
        ++set.frame_count;
        set.ids[slot] = signal.id;
        set.selectors[slot] = signal.selector;
        set.frame_bytes[slot] = frame_bytes_of(can, signal);
        set.is_flexible[slot] = signal.is_flexible || set.frame_bytes[slot] > 8;
    }
    return slot;
}

/// One count of a float is the distance to the next one, where that is largest in the travel.
double count_of(const CanSignal& signal, const Axis& axis) noexcept {
    const double size = std::abs(signal.factor);
    if (signal.type == SignalType::integer) {
        return size;
    }
    const double to_file = axis.kind == AxisKind::rotary ? 180.0 / kPi : 1.0;
    const double farthest = std::max(std::abs(axis.min * to_file - signal.offset),
                                     std::abs(axis.max * to_file - signal.offset));
    const int digits = signal.type == SignalType::float32 ? 23 : 52;
    return std::ldexp(size, std::ilogb(std::max(farthest / size, 1.0e-30)) - digits);
}

void fill_signals(const Machine& machine, AxisFrameSet& set) noexcept {
    const CanLayout& can = machine.can;
    const double frozen_s = 1.0e-6 * can.sample_us * std::max(1U, can.frozen_samples);
    for (const CanSignal& signal : can.signals) {
        const std::uint32_t slot = slot_for(signal, can, set);
        set.signal_slots[set.signal_count] = static_cast<std::uint8_t>(slot);
        set.signals[set.signal_count++] = signal;
        if (signal.role == SignalRole::counter) {
            set.counter_modulus[slot] = static_cast<std::uint16_t>(signal.mark);
        }
        if (signal.role == SignalRole::position) {
            auto& axis = set.axes[signal.axis];
            const double count = count_of(signal, machine.axes[signal.axis]);
            axis.unit = axis.kind == AxisKind::rotary ? count * (kPi / 180.0) : count;
            // Ten counts in the time after which unchanged positions count as frozen.
            axis.still_speed = 10 * count / frozen_s;
        }
    }
}

}  // namespace

AxisFrameSet make_frame_set(const Machine& machine) noexcept {
    AxisFrameSet set;
    if (!fits_set(machine)) {
        return set;
    }
    const CanLayout& can = machine.can;
    set.wire = &wire_of(can);
    set.codec = &axis_codec(*set.wire);
    set.axis_count = static_cast<std::uint32_t>(machine.axes.size());
    set.sample_us = can.sample_us;
    set.sync_id = can.sync_id;
    set.heartbeat_id = can.heartbeat_in_id;
    set.sync_counter_max =
        set.wire->mark == SampleMark::sync ? can.sync_counter_max : kSyncCounterMax;
    set.session_id = has_sample_counter(can) ? can.session_in_id : 0;
    const double unit_mm = 1.0 / set.wire->counts_per_mm;
    for (std::uint32_t i = 0; i < set.axis_count; ++i) {
        const Axis& axis = machine.axes[i];
        const double unit = axis.kind == AxisKind::linear ? unit_mm : kAngleUnitDeg * kPi / 180.0;
        set.axes[i] = {axis.kind, axis.unlimited && axis.kind == AxisKind::rotary, unit};
    }
    if (!is_native(can)) {
        fill_signals(machine, set);
        return set;
    }
    set.frame_count = own_axis_frames(*set.wire, set.axis_count);
    for (std::uint32_t i = 0; i < set.frame_count; ++i) {
        set.frame_bytes[i] =
            fd_length(set.codec->bytes + set.codec->bytes_an_axis * set.axis_count);
        set.is_flexible[i] = set.codec->is_flexible;
        set.counter_modulus[i] = set.codec->counter_modulus;
        set.ids[i] = can.axis_ids[i];
        set.data_ids[i] = can.data_ids[i];
    }
    if (can.look_ahead_samples != 0) {
        set.look_ahead_samples = can.look_ahead_samples;
        set.look_ahead_id = can.look_ahead_id;
        set.look_ahead_data_id = can.look_ahead_data_id;
        set.look_ahead_bytes = fd_length(6 + 8 * set.axis_count);
    }
    return set;
}

std::array<double, kAxesMax> axis_units(const Machine& machine) noexcept {
    const AxisFrameSet set = make_frame_set(machine);
    std::array<double, kAxesMax> units{};
    std::transform(set.axes.begin(), set.axes.end(), units.begin(),
                   [](const AxisFrameSet::AxisWire& axis) { return axis.unit; });
    return units;
}

}  // namespace axg
