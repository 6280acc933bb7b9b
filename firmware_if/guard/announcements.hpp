// SPDX-License-Identifier: Apache-2.0
// The messages that a guard sends by itself, beside permits and stops: heartbeat, hints, hashes,
// and the status for an operator; which of them is due, and when. No clock, no allocation; us.
// Times: docs/reference/axguardd.md.
#pragma once

#include <cstdint>
#include <optional>

#include "core/guard/guard_state.hpp"
#include "core/machine/machine.hpp"
#include "firmware_if/guard/operator_desk.hpp"
#include "firmware_if/guard/outbox.hpp"
#include "firmware_if/protocol/handshake.hpp"
#include "firmware_if/protocol/hints_frame.hpp"

namespace axg {

class Announcements {
  public:
    /// `machine` must outlive it.
    Announcements(const Machine& machine, const ConfigurationHashes& hashes,
                  std::int64_t now_us) noexcept;

    /// A change is sent at once.
    void set_heartbeat(GuardHeartbeat heartbeat, std::int64_t now_us) noexcept;
    /// Of the newest result; they leave with the next heartbeat.
    void set_hints(const Hints& hints) noexcept { hints_ = hints; }
    [[nodiscard]] Handshake& handshake() noexcept { return handshake_; }

    /// Puts what is due into the outbox.
    void put_due(const OperatorDesk& desk, GuardPhase phase, std::int64_t now_us,
                 Outbox& outbox) noexcept;
    [[nodiscard]] std::int64_t next_due_us() const noexcept;

  private:
    void put_status(OperatorStatus status, std::int64_t now_us, Outbox& outbox) noexcept;

    const Machine& machine_;
    GuardHeartbeat heartbeat_ = GuardHeartbeat::silent;
    std::int64_t heartbeat_us_;   // next
    std::optional<Hints> hints_;  // not sent yet
    Handshake handshake_;
    OperatorStatus status_;                   // the last one sent
    std::int64_t status_us_, status_due_us_;  // times of the last and of the next one
};

}  // namespace axg
