// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/protocol/signal_frames.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "core/base/finite.hpp"
#include "core/base/sincos.hpp"
#include "core/machine/can_id.hpp"
#include "firmware_if/protocol/wire.hpp"

namespace axg {
namespace {

using Wire = AxisFrameSet::AxisWire;
using detail::value_of;

constexpr double kDegreesPerRadian = 180.0 / kPi;

// Status word 0x6041 of CiA 402: bits 0..3 and 6 distinguish a fault from all other states.
constexpr std::uint32_t kStateBits = 0x4F;
constexpr std::uint32_t kFault = 0x08, kFaultReaction = 0x0F;
constexpr std::uint32_t kOperationEnabled = 0x0237;  // with voltage and remote

double in_one_turn(double angle_deg) noexcept {
    return angle_deg - 360.0 * std::floor(angle_deg / 360.0);
}

AxisFrameContent::Value position_of(const CanSignal& signal, const Wire& axis,
                                    std::int64_t raw) noexcept {
    double position = value_of(signal, raw);
    if (axis.kind == AxisKind::rotary) {
        position = (axis.unlimited ? in_one_turn(position) : position) * (kPi / 180.0);
    }
    return {signal.axis, raw, is_finite(position), position};
}

void add_mode(std::uint8_t mode, AxisFrameContent& out) noexcept {
    out.has_status = true;
    out.mode = std::max(out.mode, mode);
}

/// False: this signal cannot have the value.
bool add_state(const CanSignal& signal, const Wire& axis, std::int64_t raw,
               AxisFrameContent& out) noexcept {
    const auto bits = static_cast<std::uint32_t>(raw);
    const bool is_yes = raw == static_cast<std::int64_t>(signal.mark);
    switch (signal.role) {
        case SignalRole::position:
            return true;
        case SignalRole::velocity:
            add_mode(
                std::abs(value_of(signal, raw)) > axis.still_speed ? kModeMoving : kModeStandstill,
                out);
            return true;
        case SignalRole::tool: {
            const double number = value_of(signal, raw);
            const bool is_number = number >= 0 && number <= 65535;
            out.has_tool = true;
            out.tool = is_number ? static_cast<std::uint16_t>(number) : 0;
            return is_number;
        }
        case SignalRole::moving:
            add_mode(is_yes ? kModeMoving : kModeStandstill, out);
            return true;
        case SignalRole::tool_change:
            add_mode(is_yes ? kModeToolChange : kModeStandstill, out);
            return true;
        case SignalRole::homed:
            out.has_status = true;
            out.flags |= is_yes ? 0 : kFlagNotHomed;
            return true;
        case SignalRole::counter:
            out.counter = static_cast<std::uint8_t>(bits);
            return bits < signal.mark;
        case SignalRole::drive_status:
            out.has_status = true;
            out.flags |= (bits & signal.mark) == signal.mark ? 0 : kFlagNotHomed;
            if ((bits & kStateBits) == kFault || (bits & kStateBits) == kFaultReaction) {
                out.drive_in_fault = signal.axis;
            }
            return true;
    }
    return false;
}

/// The raw bits nearest to a number. False where they do not fit the signal.
bool raw_of(const CanSignal& signal, double value, std::int64_t& raw) noexcept {
    const double number = (value - signal.offset) / signal.factor;
    switch (signal.type) {
        case SignalType::float32:
            raw = std::bit_cast<std::uint32_t>(static_cast<float>(number));
            return is_finite(number) && std::abs(number) < 3.4e38;
        case SignalType::float64:
            raw = std::bit_cast<std::int64_t>(number);
            return is_finite(number);
        case SignalType::integer:
            if (!(std::abs(number) < 9.0e15)) {
                return false;
            }
            raw = std::llround(number);
            return detail::fits_signal(signal, raw);
    }
    return false;
}

/// One turn lower where an endless axis needs the negative half of its field.
bool raw_position(const CanSignal& signal, const Wire& axis, double position,
                  std::int64_t& raw) noexcept {
    const double value = axis.kind == AxisKind::rotary ? position * kDegreesPerRadian : position;
    if (!axis.unlimited || !is_finite(value)) {
        return raw_of(signal, value, raw);
    }
    const double turn = in_one_turn(value);
    return raw_of(signal, turn, raw) || raw_of(signal, turn - 360.0, raw);
}

/// mm/s or deg/s since the snapshot before.
double speed_of(const AxisFrameSet& set, const AxisSnapshot& snapshot, const AxisSnapshot& last,
                std::uint32_t axis) noexcept {
    if (last.axis_count != snapshot.axis_count || snapshot.latched_us <= last.latched_us) {
        return 0;
    }
    const Wire& wire = set.axes[axis];
    double step = snapshot.position[axis] - last.position[axis];
    if (wire.unlimited) {
        step -= 2 * kPi * std::round(step / (2 * kPi));
    }
    const double speed = step * 1.0e6 / static_cast<double>(snapshot.latched_us - last.latched_us);
    return wire.kind == AxisKind::rotary ? speed * kDegreesPerRadian : speed;
}

/// The raw value of `snapshot` in this signal; false if it does not fit.
bool raw_signal(const AxisFrameSet& set, const CanSignal& signal, const AxisSnapshot& snapshot,
                const AxisSnapshot& last, std::uint32_t counter, std::int64_t& raw) noexcept {
    const bool is_homed = (snapshot.flags & kFlagNotHomed) == 0;
    const std::int64_t no = signal.mark == 0 ? 1 : 0;
    const auto yes = static_cast<std::int64_t>(signal.mark);
    switch (signal.role) {
        case SignalRole::position:
            return raw_position(signal, set.axes[signal.axis], snapshot.position[signal.axis], raw);
        case SignalRole::velocity:
            return raw_of(signal, speed_of(set, snapshot, last, signal.axis), raw);
        case SignalRole::tool:
            return raw_of(signal, snapshot.tool, raw);
        case SignalRole::moving:
            raw = snapshot.mode == kModeMoving ? yes : no;
            return true;
        case SignalRole::tool_change:
            raw = snapshot.mode == kModeToolChange ? yes : no;
            return true;
        case SignalRole::homed:
            raw = is_homed ? yes : no;
            return true;
        case SignalRole::counter:
            raw = counter % std::max<std::int64_t>(1, yes);
            return true;
        case SignalRole::drive_status:
            raw = kOperationEnabled | (is_homed ? yes : 0);
            return true;
    }
    return false;
}

/// Modes may share their bits (state 1: moving, 2: tool change), so a no is written before any yes.
bool is_no(const CanSignal& signal, std::int64_t raw) noexcept {
    const bool is_mode =
        signal.role == SignalRole::moving || signal.role == SignalRole::tool_change;
    return is_mode && raw != static_cast<std::int64_t>(signal.mark);
}

}  // namespace

FrameStatus decode_signals(const AxisFrameSet& set, std::uint32_t slot, const CanFrame& frame,
                           AxisFrameContent& out) noexcept {
    for (std::uint32_t i = 0; i < set.signal_count; ++i) {
        const CanSignal& signal = set.signals[i];
        if (set.signal_slots[i] != slot) {
            continue;
        }
        const std::int64_t raw = detail::get_signal(signal, frame.data.data());
        const Wire& axis = set.axes[signal.axis < kAxesMax ? signal.axis : 0];
        if (signal.role == SignalRole::position) {
            out.values[out.value_count++] = position_of(signal, axis, raw);
        } else if (!add_state(signal, axis, raw, out)) {
            return FrameStatus::bad_format;
        }
    }
    return FrameStatus::ok;
}

std::uint32_t fill_signals(const AxisFrameSet& set, const AxisSnapshot& snapshot,
                           const AxisSnapshot& last, std::uint32_t counter,
                           std::span<CanFrame> out) noexcept {
    for (std::uint32_t slot = 0; slot < set.frame_count; ++slot) {
        CanFrame& frame = out[slot];
        frame = CanFrame{};
        frame.id = id_number(set.ids[slot]);
        frame.extended = is_extended_id(set.ids[slot]);
        frame.length_bytes = set.frame_bytes[slot];
        frame.fd = frame.bit_rate_switch = set.is_flexible[slot];
        detail::put_selector(set.selectors[slot], frame.data.data());
    }
    for (const bool writes_no : {true, false}) {
        for (std::uint32_t i = 0; i < set.signal_count; ++i) {
            const CanSignal& signal = set.signals[i];
            std::int64_t raw = 0;
            if (!raw_signal(set, signal, snapshot, last, counter, raw)) {
                return signal.role == SignalRole::tool ? set.axis_count : signal.axis;
            }
            if (is_no(signal, raw) == writes_no) {
                detail::put_signal(signal, raw, out[set.signal_slots[i]].data.data());
            }
        }
    }
    return kNoIndex;
}

}  // namespace axg
