// SPDX-License-Identifier: Apache-2.0
// The frames the guard would have sent, cycle by cycle, into a log. In order of time.
#pragma once

#include <cstdint>
#include <string>

#include "hil_replay/replay/guard_sender.hpp"
#include "hil_replay/trace/candump_log.hpp"

namespace axg {

class GuardLog {
  public:
    GuardLog(const CanLayout& layout, const std::string& path)
        : writer_(path), sender_(layout, [this](const CanFrame& f) { writer_.write(f); }) {}
    GuardLog(const GuardLog&) = delete;  // the sender holds its address
    GuardLog& operator=(const GuardLog&) = delete;

    /// One decided cycle. `time_us`: when its frames leave, the arrival of its sample; times must
    /// not decrease.
    void on_cycle(const CycleResult& result, std::uint8_t live_counter, std::uint8_t sync_counter,
                  std::int64_t time_us) {
        sender_.on_cycle(result, live_counter, sync_counter, time_us);
    }
    /// A stop without a snapshot: the receiver gave up.
    void on_input_lost(std::int64_t time_us) { sender_.on_input_lost(time_us); }
    /// Sends what is still due, then gives the log its name.
    [[nodiscard]] bool finish() {
        sender_.send_due(INT64_MAX);
        return writer_.finish();
    }
    [[nodiscard]] const std::string& error() const noexcept { return writer_.error(); }

  private:
    CandumpWriter writer_;
    GuardSender sender_;
};

}  // namespace axg
