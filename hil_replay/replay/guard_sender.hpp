// SPDX-License-Identifier: Apache-2.0
// The frames that a decided cycle comes to: permit pairs, the stop and its repeats, the emergency
// message, the heartbeat. In order of time, to whoever takes them: a log, a wire.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "core/guard/monitor.hpp"
#include "firmware_if/protocol/guard_frames.hpp"

namespace axg {

class GuardSender {
  public:
    /// `layout` must outlive the sender.
    GuardSender(const CanLayout& layout, std::function<void(const CanFrame&)> send);

    /// One decided cycle. `time_us`: when its frames leave; times must not decrease.
    void on_cycle(const CycleResult& result, std::uint8_t live_counter, std::uint8_t sync_counter,
                  std::int64_t time_us);
    /// A stop without a snapshot: the receiver gave up.
    void on_input_lost(std::int64_t time_us);
    /// Sends what is due by then.
    void send_due(std::int64_t until_us);

  private:
    void send_stop(EmergencyCode code, std::uint32_t pair, std::int64_t time_us);
    void send_heartbeat(bool has_permit, std::int64_t time_us);

    const CanLayout& layout_;
    std::function<void(const CanFrame&)> send_;
    std::vector<CanFrame> due_;  // repeats of the stop, in order of time
    std::int64_t heartbeat_us_ = 0;
    bool has_heartbeat_ = false, is_tripped_ = false;
};

}  // namespace axg
