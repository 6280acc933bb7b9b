// SPDX-License-Identifier: Apache-2.0
// From the machine's layout to fixed arrays, or to the reason why the two do not fit.
#include <algorithm>
#include <cmath>

#include "core/base/sincos.hpp"
#include "core/machine/can_id.hpp"
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

constexpr std::uint32_t frames_needed(CanFormat format, std::size_t axis_count) noexcept {
    return format == CanFormat::fd ? 1U : static_cast<std::uint32_t>((axis_count + 2) / 2);
}

constexpr bool has_signals(CanFormat format) noexcept {
    return format == CanFormat::signals || format == CanFormat::cia402;
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

LayoutStatus check_signal(const CanLayout& can, const CanSignal& signal, bool unlimited) noexcept {
    const std::uint8_t bytes = frame_bytes_of(can, signal);
    if (bytes < 1 || (bytes > 8 && fd_length(bytes) != bytes)) {
        return LayoutStatus::signal_frame_length;
    }
    if (!is_wire_id(signal.id)) {
        return LayoutStatus::id_out_of_range;
    }
    // A double holds 53 bits: more would round silently.
    const bool is_float = signal.type != SignalType::integer;
    if (signal.length_bits == 0 || (signal.length_bits > 53 && !is_float) ||
        !is_inside(detail::bits_of(signal), bytes)) {
        return LayoutStatus::signal_outside_frame;
    }
    // A float loses resolution with every turn, so none for an endless axis.
    const int float_bits = signal.type == SignalType::float32 ? 32 : 64;
    const bool is_number = signal.role == SignalRole::position ||
                           signal.role == SignalRole::velocity || signal.role == SignalRole::tool;
    if (is_float && (signal.length_bits != float_bits || !is_number || unlimited)) {
        return LayoutStatus::signal_type;
    }
    const bool is_count = signal.role == SignalRole::counter;
    if (is_count && (signal.is_signed || signal.length_bits > 8 || signal.mark < 2 ||
                     signal.mark > 1U << signal.length_bits)) {
        return LayoutStatus::signal_type;
    }
    const SignalSelector& selector = signal.selector;
    if (selector.length_bits > 32 ||
        (selector.length_bits != 0 && !is_inside(detail::bits_of(selector), bytes))) {
        return LayoutStatus::signal_selector;
    }
    const bool is_scale =
        std::isfinite(signal.factor) && signal.factor != 0 && std::isfinite(signal.offset);
    return is_scale ? LayoutStatus::ok : LayoutStatus::signal_scale;
}

constexpr bool belongs_to_axis(SignalRole role) noexcept {
    return role == SignalRole::position || role == SignalRole::velocity ||
           role == SignalRole::drive_status;
}

/// Checks that two signals have different meanings, and that frames with one id have one shape.
LayoutStatus check_two(const CanLayout& can, const CanSignal& a, const CanSignal& b) noexcept {
    const bool is_frame = a.id == b.id && a.selector == b.selector;
    if (a.role == b.role) {
        const bool is_same = belongs_to_axis(a.role)         ? a.axis == b.axis
                             : a.role == SignalRole::counter ? is_frame
                                                             : true;
        if (is_same) {
            return LayoutStatus::signal_twice;
        }
    }
    if (a.id != b.id) {
        return LayoutStatus::ok;
    }
    // The same bits select all frames of an id, or there is one such frame without a selector.
    const bool is_same_selector =
        a.selector.length_bits == b.selector.length_bits &&
        (a.selector.length_bits == 0 ||
         (a.selector.start_bit == b.selector.start_bit && a.selector.order == b.selector.order));
    if (!is_same_selector) {
        return LayoutStatus::signal_selector;
    }
    const bool is_same_shape =
        frame_bytes_of(can, a) == frame_bytes_of(can, b) && a.is_flexible == b.is_flexible;
    return is_same_shape ? LayoutStatus::ok : LayoutStatus::signal_frame_length;
}

LayoutStatus check_signals(const Machine& machine) noexcept {
    const CanLayout& can = machine.can;
    if (can.signals.size() > kSignalsMax) {
        return LayoutStatus::too_many_signals;
    }
    std::size_t positions = 0;
    std::size_t frames = 0;
    for (std::size_t i = 0; i < can.signals.size(); ++i) {
        const CanSignal& signal = can.signals[i];
        const bool has_axis = belongs_to_axis(signal.role);
        if (has_axis && signal.axis >= machine.axes.size()) {
            return LayoutStatus::signal_missing;
        }
        LayoutStatus status =
            check_signal(can, signal, has_axis && machine.axes[signal.axis].unlimited);
        bool is_new_frame = true;
        for (std::size_t j = 0; j < i && status == LayoutStatus::ok; ++j) {
            status = check_two(can, can.signals[j], signal);
            is_new_frame = is_new_frame && (can.signals[j].id != signal.id ||
                                            can.signals[j].selector != signal.selector);
        }
        if (status != LayoutStatus::ok) {
            return status;
        }
        positions += signal.role == SignalRole::position ? 1 : 0;
        frames += is_new_frame ? 1 : 0;
    }
    if (frames > kAxisFramesMax) {
        return LayoutStatus::too_many_signals;
    }
    return positions == machine.axes.size() ? LayoutStatus::ok : LayoutStatus::signal_missing;
}

LayoutStatus check_look_ahead(const Machine& machine) noexcept {
    const CanLayout& can = machine.can;
    if (can.look_ahead_samples == 0) {
        return LayoutStatus::ok;
    }
    if (can.format != CanFormat::fd) {
        return LayoutStatus::look_ahead_format;
    }
    if (machine.axes.size() > kLookAheadAxesMax) {
        return LayoutStatus::look_ahead_axes;
    }
    const bool is_good = can.look_ahead_samples >= kLookAheadSamplesMin &&
                         can.look_ahead_samples <= kLookAheadSamplesMax;
    return is_good ? LayoutStatus::ok : LayoutStatus::look_ahead_samples;
}

LayoutStatus check_ids(const Machine& machine) noexcept {
    const CanLayout& can = machine.can;
    std::array<std::uint32_t, kAxisFramesMax + 14> ids{};
    std::size_t count = 0;
    for (const std::uint32_t id :
         {can.permit_id, can.permit_id + 1, can.stop_id, can.emergency_id, can.heartbeat_out_id}) {
        ids[count++] = id;
    }
    if (can.format == CanFormat::cia402) {
        ids[count++] = can.sync_id;
    }
    if (!has_signals(can.format)) {
        const std::uint32_t frames = frames_needed(can.format, machine.axes.size());
        if (can.axis_ids.size() < frames) {
            return LayoutStatus::too_few_ids;
        }
        if (can.data_ids.size() < frames) {
            return LayoutStatus::too_few_data_ids;
        }
        ids[count++] = can.sync_id;
        ids[count++] = can.heartbeat_in_id;
        for (std::uint32_t i = 0; i < frames; ++i) {
            ids[count++] = can.axis_ids[i];
        }
    }
    if (can.look_ahead_samples != 0) {
        ids[count++] = can.look_ahead_id;
    }
    if (can.hashes_out_id != 0) {
        ids[count++] = can.hashes_in_id;
        ids[count++] = can.hashes_out_id;
    }
    if (has_sample_counter(can)) {
        for (const std::uint32_t id :
             {can.session_in_id, can.hints_id, can.operator_in_id, can.operator_out_id}) {
            ids[count++] = id;
        }
    }
    for (std::size_t i = 0; i < count; ++i) {
        if (ids[i] > kStandardIdMax) {
            return LayoutStatus::id_out_of_range;
        }
        for (std::size_t j = 0; j < i; ++j) {
            if (ids[i] == ids[j]) {
                return LayoutStatus::id_used_twice;
            }
        }
    }
    if (has_signals(can.format)) {  // signals may share a frame, not an id of ours
        for (const CanSignal& signal : can.signals) {
            if (std::find(ids.begin(), ids.begin() + count, signal.id) != ids.begin() + count) {
                return LayoutStatus::id_used_twice;
            }
        }
    }
    return LayoutStatus::ok;
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

const char* to_text(LayoutStatus status) noexcept {
    switch (status) {
        case LayoutStatus::ok:
            return "ok";
        case LayoutStatus::no_axes:
            return "the machine has no axes";
        case LayoutStatus::too_many_axes:
            return "more axes than the format carries: 16, or 13 with format fd";
        case LayoutStatus::no_sample_period:
            return "can.sample_us is 0";
        case LayoutStatus::too_few_ids:
            return "too few can.ids.axes: classical needs one for every two of axes + 1, fd one";
        case LayoutStatus::too_few_data_ids:
            return "too few can.data_ids: one for each axis frame";
        case LayoutStatus::id_out_of_range:
            return "a CAN id above 0x7FF, or of a signal above 29 bits (the permit's twin uses the "
                   "next id)";
        case LayoutStatus::id_used_twice:
            return "a CAN id is used twice (the permit's twin uses the next id)";
        case LayoutStatus::look_ahead_format:
            return "can.ahead needs format fd: its frame has 48 bytes for five axes";
        case LayoutStatus::look_ahead_axes:
            return "can.ahead: more axes than its frame carries: 7";
        case LayoutStatus::look_ahead_samples:
            return "can.ahead.samples must be 4 to 1024";
        case LayoutStatus::signal_missing:
            return "can.signals: an axis has no signal, or a signal names no axis";
        case LayoutStatus::signal_twice:
            return "can.signals: an axis, or a state, has two signals";
        case LayoutStatus::signal_outside_frame:
            return "can.signals: a signal of 1 to 53 bits must lie within signal_frame_bytes";
        case LayoutStatus::signal_scale:
            return "can.signals: factor must be finite and not 0, offset finite";
        case LayoutStatus::signal_frame_length:
            return "can.signals: a frame has one length, a CAN payload length from 1 to 64";
        case LayoutStatus::signal_type:
            return "can.signals: floats have 32 or 64 bits and no endless axis, counters 8 bits";
        case LayoutStatus::signal_selector:
            return "can.signals: frames of one id take turns by the same bits, or none does";
        case LayoutStatus::too_many_signals:
            return "can.signals: at most 96 signals in 36 frames";
    }
    return "unknown";
}

LayoutStatus check_layout(const Machine& machine) noexcept {
    if (machine.axes.empty()) {
        return LayoutStatus::no_axes;
    }
    const bool is_fd = machine.can.format == CanFormat::fd;
    if (machine.axes.size() > (is_fd ? kFdAxesMax : kAxesMax)) {
        return LayoutStatus::too_many_axes;
    }
    if (machine.can.sample_us == 0) {
        return LayoutStatus::no_sample_period;
    }
    if (has_signals(machine.can.format)) {
        const LayoutStatus status = check_signals(machine);
        if (status != LayoutStatus::ok) {
            return status;
        }
    }
    const LayoutStatus look_ahead = check_look_ahead(machine);
    return look_ahead != LayoutStatus::ok ? look_ahead : check_ids(machine);
}

AxisFrameSet make_frame_set(const Machine& machine) noexcept {
    AxisFrameSet set;
    set.status = check_layout(machine);
    if (set.status != LayoutStatus::ok) {
        return set;
    }
    const CanLayout& can = machine.can;
    set.format = can.format;
    set.axis_count = static_cast<std::uint32_t>(machine.axes.size());
    set.sample_us = can.sample_us;
    set.sync_id = can.sync_id;
    set.heartbeat_id = can.heartbeat_in_id;
    set.sync_counter_max = can.format == CanFormat::cia402 ? can.sync_counter_max : kSyncCounterMax;
    set.session_id = has_sample_counter(can) ? can.session_in_id : 0;
    const double unit_mm = can.format == CanFormat::fd ? kFdUnitMm : kClassicalUnitMm;
    for (std::uint32_t i = 0; i < set.axis_count; ++i) {
        const Axis& axis = machine.axes[i];
        const double unit = axis.kind == AxisKind::linear ? unit_mm : kAngleUnitDeg * kPi / 180.0;
        set.axes[i] = {axis.kind, axis.unlimited && axis.kind == AxisKind::rotary, unit};
    }
    if (has_signals(can.format)) {
        fill_signals(machine, set);
        return set;
    }
    set.frame_count = frames_needed(can.format, set.axis_count);
    const bool is_fd = can.format == CanFormat::fd;
    for (std::uint32_t i = 0; i < set.frame_count; ++i) {
        set.frame_bytes[i] = is_fd ? fd_length(12 + 4 * set.axis_count) : 8;
        set.is_flexible[i] = is_fd;
        set.counter_modulus[i] = is_fd ? 256 : 16;
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

}  // namespace axg
