// SPDX-License-Identifier: Apache-2.0
// The frames the guard would have sent, cycle by cycle, into a log: permit pairs, the stop and its
// repeats, the emergency message, the heartbeat. In order of time.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/monitor.hpp"
#include "firmware_if/guard_frames.hpp"
#include "hil_replay/candump_log.hpp"

namespace axg {

class GuardOutput {
  public:
    GuardOutput(const CanLayout& layout, const std::string& path);

    /// One decided cycle. `time_us`: when its frames leave, the arrival of its sample; times must
    /// not decrease.
    void on_cycle(const CycleResult& result, std::uint8_t live_counter, std::uint8_t sync_counter,
                  std::int64_t time_us);
    /// A stop without a picture: the receiver gave up.
    void on_input_lost(std::int64_t time_us);
    /// Sends what is still due, then gives the log its name.
    [[nodiscard]] bool finish();
    [[nodiscard]] const std::string& error() const noexcept { return writer_.error(); }

  private:
    void send_stop(EmergencyCode code, std::uint32_t pair, std::int64_t time_us);
    void send_due(std::int64_t until_us);
    void send_heartbeat(bool has_permit, std::int64_t time_us);

    const CanLayout& layout_;
    CandumpWriter writer_;
    std::vector<CanFrame> due_;  // repeats of the stop, in order of time
    std::int64_t heartbeat_us_ = 0;
    bool has_heartbeat_ = false, is_tripped_ = false;
};

}  // namespace axg
