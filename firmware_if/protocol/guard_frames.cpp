// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/protocol/guard_frames.hpp"

#include <algorithm>
#include <cmath>

#include "firmware_if/protocol/wire.hpp"

namespace axg {
namespace {

using detail::get_little;
using detail::put_little;

CanFrame plain_frame(std::uint32_t id, std::uint8_t length, std::int64_t time_us) noexcept {
    CanFrame frame;
    frame.id = id;
    frame.length_bytes = length;
    frame.time_us = time_us;
    return frame;
}

bool has_shape(const CanFrame& frame, std::uint8_t length) noexcept {
    return !frame.extended && !frame.remote && !frame.error && !frame.fd && frame.raw_dlc == 0 &&
           frame.length_bytes == length;
}

/// Whether the frame is for this id, and if so whether it has the shape of its kind.
GuardFrameStatus shape_of(const CanFrame& frame, std::uint32_t id, std::uint8_t length) noexcept {
    if (frame.error || frame.extended || frame.id != id) {
        return GuardFrameStatus::not_ours;
    }
    return has_shape(frame, length) ? GuardFrameStatus::ok : GuardFrameStatus::bad_shape;
}

EmergencyCode code_of_verdict(StopReason reason) noexcept {
    switch (reason) {
        case StopReason::predicted:
            return EmergencyCode::predicted_collision;
        case StopReason::contact:
        case StopReason::contained:
        case StopReason::capacity:
        case StopReason::engine:
            return EmergencyCode::contact;  // not proven apart counts as touching
        case StopReason::known_answer:
            return EmergencyCode::known_answer;
        case StopReason::tool:
            return EmergencyCode::model_hash;
        case StopReason::snapshot:
        case StopReason::left_path:
        case StopReason::left_jog:
        case StopReason::left_travel:
        case StopReason::left_limits:
        case StopReason::left_cap:
        case StopReason::own_stop:
        case StopReason::input:
        case StopReason::none:
            break;
    }
    return EmergencyCode::input_stale;
}

}  // namespace

CanFrame encode_stop(const CanLayout& layout, std::int64_t time_us) noexcept {
    return plain_frame(layout.stop_id, 0, time_us);
}

CanFrame encode_quick_stop(std::uint32_t id, std::int64_t time_us) noexcept {
    constexpr std::uint16_t kQuickStop = 0x0002;  // enable voltage, and not "no quick stop"
    CanFrame frame = plain_frame(id, 2, time_us);
    put_little(frame.data.data(), kQuickStop, 2);
    return frame;
}

const char* to_text(EmergencyCode code) noexcept {
    switch (code) {
        case EmergencyCode::reset:
            return "reset";
        case EmergencyCode::bus:
            return "bus";
        case EmergencyCode::predicted_collision:
            return "predicted_collision";
        case EmergencyCode::contact:
            return "contact";
        case EmergencyCode::deadline:
            return "deadline";
        case EmergencyCode::known_answer:
            return "known_answer";
        case EmergencyCode::input_stale:
            return "input_stale";
        case EmergencyCode::model_hash:
            return "model_hash";
    }
    return "unknown";
}

EmergencyCode emergency_code_of(GuardFault cause, StopReason reason) noexcept {
    switch (cause) {
        case GuardFault::verdict:
            return code_of_verdict(reason);
        case GuardFault::engine:
        case GuardFault::gap:
        case GuardFault::silence:
        case GuardFault::flapping:
            return EmergencyCode::deadline;
        case GuardFault::output:
        case GuardFault::second_guard:
        case GuardFault::foreign_stop:
            return EmergencyCode::bus;
        case GuardFault::refused:
        case GuardFault::latched:
            return EmergencyCode::model_hash;
        case GuardFault::none:
        case GuardFault::input_noise:
        case GuardFault::recorder:
        case GuardFault::input:
            break;
    }
    return EmergencyCode::input_stale;
}

CanFrame encode_emergency(const CanLayout& layout, const Emergency& emergency,
                          std::int64_t time_us) noexcept {
    CanFrame frame = plain_frame(layout.emergency_id, 8, time_us);
    std::uint8_t* data = frame.data.data();
    put_little(data, static_cast<std::uint16_t>(emergency.code), 2);
    data[2] = emergency.error_register;
    data[3] = emergency.pair;
    put_little(data + 4, static_cast<std::uint16_t>(emergency.clearance_10um), 2);
    put_little(data + 6, emergency.time_to_contact_100us, 2);
    return frame;
}

std::int16_t emergency_clearance(double clearance_mm) noexcept {
    const double count = std::isfinite(clearance_mm) ? std::floor(clearance_mm * 100) : 0;
    return static_cast<std::int16_t>(std::clamp(count, -32768.0, 32767.0));
}

std::uint16_t emergency_time(double time_s) noexcept {
    const double count = std::isfinite(time_s) ? std::floor(time_s * 1.0e4) : 0;
    return static_cast<std::uint16_t>(std::clamp(count, 0.0, 65535.0));
}

CanFrame encode_guard_heartbeat(const CanLayout& layout, GuardHeartbeat heartbeat,
                                std::int64_t time_us) noexcept {
    CanFrame frame = plain_frame(layout.heartbeat_out_id, 1, time_us);
    frame.data[0] = static_cast<std::uint8_t>(heartbeat);
    return frame;
}

GuardFrameStatus decode_emergency(const CanLayout& layout, const CanFrame& frame,
                                  Emergency& out) noexcept {
    const GuardFrameStatus shape = shape_of(frame, layout.emergency_id, 8);
    if (shape != GuardFrameStatus::ok) {
        return shape;
    }
    const std::uint8_t* data = frame.data.data();
    const auto code = static_cast<std::uint16_t>(get_little(data, 2));
    const bool is_known =
        code == 0 || (code & 0xFF00U) == 0x8100U || (code >= 0xFF01U && code <= 0xFF06U);
    if (!is_known) {
        return GuardFrameStatus::bad_word;
    }
    out = {static_cast<EmergencyCode>(code), data[2], data[3],
           static_cast<std::int16_t>(get_little(data + 4, 2)),
           static_cast<std::uint16_t>(get_little(data + 6, 2))};
    return GuardFrameStatus::ok;
}

GuardFrameStatus decode_stop(const CanLayout& layout, const CanFrame& frame) noexcept {
    return shape_of(frame, layout.stop_id, 0);
}

GuardFrameStatus decode_guard_heartbeat(const CanLayout& layout, const CanFrame& frame,
                                        GuardHeartbeat& out) noexcept {
    const GuardFrameStatus shape = shape_of(frame, layout.heartbeat_out_id, 1);
    if (shape != GuardFrameStatus::ok) {
        return shape;
    }
    const auto heartbeat = static_cast<GuardHeartbeat>(frame.data[0]);
    if (heartbeat != GuardHeartbeat::running && heartbeat != GuardHeartbeat::tripped &&
        heartbeat != GuardHeartbeat::starting) {
        return GuardFrameStatus::bad_word;
    }
    out = heartbeat;
    return GuardFrameStatus::ok;
}

}  // namespace axg
