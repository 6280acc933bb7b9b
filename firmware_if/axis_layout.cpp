// SPDX-License-Identifier: Apache-2.0
// From the machine's layout to fixed arrays, or to the reason why the two do not fit.
#include <algorithm>
#include <cmath>

#include "core/sincos.hpp"
#include "firmware_if/axis_frames.hpp"

namespace axg {
namespace {

constexpr std::uint32_t kStandardIdMax = 0x7FF;

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

/// Bit positions of a big-endian signal run down a byte and on at the top of the next one.
bool signal_fits(const CanSignal& signal, std::uint32_t frame_bytes) noexcept {
    if (signal.length_bits == 0 || signal.length_bits > 53) {
        return false;  // a double holds 53 bits: more would round silently
    }
    const std::uint32_t first = signal.order == ByteOrder::little
                                    ? signal.start_bit
                                    : signal.start_bit / 8U * 8U + 7U - signal.start_bit % 8U;
    return first + signal.length_bits <= frame_bytes * 8U;
}

LayoutStatus check_signals(const Machine& machine) noexcept {
    const CanLayout& can = machine.can;
    const bool is_length = can.signal_frame_bytes >= 1 &&
                           (can.signal_frame_bytes <= 8 ||
                            fd_length(can.signal_frame_bytes) == can.signal_frame_bytes);
    if (!is_length) {
        return LayoutStatus::signal_frame_length;
    }
    std::array<bool, kAxesMax> seen{};
    bool tool_seen = false;
    for (const CanSignal& signal : can.signals) {
        if (signal.axis != kNoIndex && signal.axis >= machine.axes.size()) {
            return LayoutStatus::signal_missing;
        }
        bool& mark = signal.axis == kNoIndex ? tool_seen : seen[signal.axis];
        if (mark) {
            return LayoutStatus::signal_twice;
        }
        mark = true;
        if (signal.id > kStandardIdMax) {
            return LayoutStatus::id_out_of_range;
        }
        if (!signal_fits(signal, can.signal_frame_bytes)) {
            return LayoutStatus::signal_outside_frame;
        }
        if (!std::isfinite(signal.factor) || signal.factor == 0 || !std::isfinite(signal.offset)) {
            return LayoutStatus::signal_scale;
        }
    }
    const auto seen_count = std::count(seen.begin(), seen.end(), true);
    return static_cast<std::size_t>(seen_count) == machine.axes.size()
               ? LayoutStatus::ok
               : LayoutStatus::signal_missing;
}

LayoutStatus check_ahead(const Machine& machine) noexcept {
    const CanLayout& can = machine.can;
    if (can.ahead_samples == 0) {
        return LayoutStatus::ok;
    }
    if (can.format != CanFormat::fd) {
        return LayoutStatus::ahead_format;
    }
    if (machine.axes.size() > kAheadAxesMax) {
        return LayoutStatus::ahead_axes;
    }
    const bool is_good =
        can.ahead_samples >= kAheadSamplesMin && can.ahead_samples <= kAheadSamplesMax;
    return is_good ? LayoutStatus::ok : LayoutStatus::ahead_samples;
}

LayoutStatus check_ids(const Machine& machine) noexcept {
    const CanLayout& can = machine.can;
    std::array<std::uint32_t, kAxisFramesMax + 8> ids{};
    std::size_t count = 0;
    for (const std::uint32_t id :
         {can.permit_id, can.permit_id + 1, can.stop_id, can.emergency_id, can.heartbeat_out_id}) {
        ids[count++] = id;
    }
    if (can.format != CanFormat::signals) {
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
    if (can.ahead_samples != 0) {
        ids[count++] = can.ahead_id;
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
    if (can.format == CanFormat::signals) {  // signals may share a frame, not an id of ours
        for (const CanSignal& signal : can.signals) {
            if (std::find(ids.begin(), ids.begin() + count, signal.id) != ids.begin() + count) {
                return LayoutStatus::id_used_twice;
            }
        }
    }
    return LayoutStatus::ok;
}

void fill_signals(const CanLayout& can, AxisFrameSet& set) noexcept {
    set.frame_bytes = can.signal_frame_bytes;
    for (const CanSignal& signal : can.signals) {
        set.signals[set.signal_count++] = signal;
        const auto end = set.ids.begin() + set.frame_count;
        if (std::find(set.ids.begin(), end, signal.id) == end) {
            set.ids[set.frame_count++] = signal.id;
        }
        if (signal.axis != kNoIndex) {
            auto& axis = set.axes[signal.axis];
            axis.unit = std::abs(signal.factor);
            if (axis.kind == AxisKind::rotary) {
                axis.unit *= kPi / 180.0;
            }
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
            return "a CAN id above 0x7FF (the permit's twin takes the id after it)";
        case LayoutStatus::id_used_twice:
            return "a CAN id is used for two things (the permit's twin takes the id after it)";
        case LayoutStatus::ahead_format:
            return "can.ahead needs format fd: its frame has 48 bytes for five axes";
        case LayoutStatus::ahead_axes:
            return "can.ahead: more axes than its frame carries: 7";
        case LayoutStatus::ahead_samples:
            return "can.ahead.samples must be 4 to 1024";
        case LayoutStatus::signal_missing:
            return "can.signals: an axis has no signal, or a signal names no axis";
        case LayoutStatus::signal_twice:
            return "can.signals: an axis has two signals";
        case LayoutStatus::signal_outside_frame:
            return "can.signals: a signal of 1 to 53 bits must lie within signal_frame_bytes";
        case LayoutStatus::signal_scale:
            return "can.signals: factor must be finite and not 0, offset finite";
        case LayoutStatus::signal_frame_length:
            return "can.signal_frame_bytes must be a CAN payload length from 1 to 64";
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
    if (machine.can.format == CanFormat::signals) {
        const LayoutStatus status = check_signals(machine);
        if (status != LayoutStatus::ok) {
            return status;
        }
    }
    const LayoutStatus ahead = check_ahead(machine);
    return ahead != LayoutStatus::ok ? ahead : check_ids(machine);
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
    const double unit_mm = can.format == CanFormat::fd ? kFdUnitMm : kClassicalUnitMm;
    for (std::uint32_t i = 0; i < set.axis_count; ++i) {
        const Axis& axis = machine.axes[i];
        const double unit = axis.kind == AxisKind::linear ? unit_mm : kAngleUnitDeg * kPi / 180.0;
        set.axes[i] = {axis.kind, axis.unlimited && axis.kind == AxisKind::rotary, unit};
    }
    if (can.format == CanFormat::signals) {
        fill_signals(can, set);
        return set;
    }
    set.frame_count = frames_needed(can.format, set.axis_count);
    set.frame_bytes = can.format == CanFormat::fd ? fd_length(12 + 4 * set.axis_count) : 8;
    for (std::uint32_t i = 0; i < set.frame_count; ++i) {
        set.ids[i] = can.axis_ids[i];
        set.data_ids[i] = can.data_ids[i];
    }
    if (can.ahead_samples != 0) {
        set.ahead_samples = can.ahead_samples;
        set.ahead_id = can.ahead_id;
        set.ahead_data_id = can.ahead_data_id;
        set.ahead_bytes = fd_length(6 + 8 * set.axis_count);
    }
    return set;
}

}  // namespace axg
