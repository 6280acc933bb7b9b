// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/replay/guard_sender.hpp"

#include <algorithm>
#include <utility>

#include "firmware_if/protocol/axis_frames.hpp"

namespace axg {

GuardSender::GuardSender(const CanLayout& layout, std::function<void(const CanFrame&)> send)
    : layout_(layout), send_(std::move(send)) {}

void GuardSender::send_due(std::int64_t until_us) {
    const auto later = std::find_if(due_.begin(), due_.end(),
                                    [until_us](const CanFrame& f) { return f.time_us > until_us; });
    std::for_each(due_.begin(), later, send_);
    due_.erase(due_.begin(), later);
}

void GuardSender::send_heartbeat(bool has_permit, std::int64_t time_us) {
    if (has_heartbeat_ && time_us - heartbeat_us_ < kHeartbeatPeriodUs) {
        return;
    }
    has_heartbeat_ = true;
    heartbeat_us_ = time_us;
    const GuardHeartbeat heartbeat = is_tripped_  ? GuardHeartbeat::tripped
                                     : has_permit ? GuardHeartbeat::running
                                                  : GuardHeartbeat::starting;
    send_(encode_guard_heartbeat(layout_, heartbeat, time_us));
}

void GuardSender::send_stop(EmergencyCode code, std::uint32_t pair, std::int64_t time_us) {
    is_tripped_ = true;
    for (std::uint32_t i = 0; i < kStopRepeats; ++i) {
        const auto put = [&](const CanFrame& frame) {
            i == 0 ? send_(frame) : due_.push_back(frame);
        };
        const std::int64_t at_us = time_us + i * kStopSpacingUs;
        put(encode_stop(layout_, at_us));
        for (const std::uint32_t id : layout_.quick_stop_ids) {
            put(encode_quick_stop(id, at_us));
        }
    }
    Emergency emergency;
    emergency.code = code;
    emergency.error_register = 1;
    emergency.pair = static_cast<std::uint8_t>(std::min<std::uint32_t>(pair, 255));
    send_(encode_emergency(layout_, emergency, time_us));
}

void GuardSender::on_cycle(const CycleResult& result, std::uint8_t live_counter,
                           std::uint8_t sync_counter, std::int64_t time_us) {
    send_due(time_us);
    if (result.stops_now) {
        send_stop(emergency_code_of(result.reason), result.pair, time_us);
    }
    const Permit permit = permit_of(result, live_counter, sync_counter);
    for (const CanFrame& frame : encode_permit(layout_, permit, time_us)) {
        send_(frame);
    }
    send_heartbeat(result.has_permit, time_us);
}

void GuardSender::on_input_lost(std::int64_t time_us) {
    send_due(time_us);
    send_stop(EmergencyCode::input_stale, kNoIndex, time_us);
}

}  // namespace axg
