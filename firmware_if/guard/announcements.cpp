// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/guard/announcements.hpp"

#include <algorithm>

#include "firmware_if/protocol/axis_frames.hpp"
#include "firmware_if/protocol/guard_frames.hpp"

namespace axg {
namespace {

bool is_same(const OperatorStatus& a, const OperatorStatus& b) noexcept {
    return a.phase == b.phase && a.action == b.action && a.refusal == b.refusal &&
           a.nonce == b.nonce;
}

}  // namespace

Announcements::Announcements(const Machine& machine, const ConfigurationHashes& hashes,
                             std::int64_t now_us) noexcept
    : machine_(machine),
      heartbeat_us_(now_us),
      handshake_(machine.can, hashes),
      status_us_(now_us - kOperatorStatusUs),
      status_due_us_(has_sample_counter(machine.can) ? now_us : INT64_MAX) {}

void Announcements::set_heartbeat(GuardHeartbeat heartbeat, std::int64_t now_us) noexcept {
    if (heartbeat != heartbeat_) {
        heartbeat_ = heartbeat;
        heartbeat_us_ = now_us;
    }
}

void Announcements::put_due(const OperatorDesk& desk, GuardPhase phase, std::int64_t now_us,
                            Outbox& outbox) noexcept {
    if (now_us >= heartbeat_us_) {
        heartbeat_us_ = std::max(heartbeat_us_ + kHeartbeatPeriodUs, now_us);
        if (heartbeat_ != GuardHeartbeat::silent) {
            outbox.put_heartbeat(encode_guard_heartbeat(machine_.can, heartbeat_, now_us));
        }
        if (hints_) {
            outbox.put_hints(encode_hints(machine_.can, *hints_, now_us));
            hints_.reset();
        }
    }
    if (now_us >= handshake_.next_due_us()) {
        outbox.put_hash(handshake_.next(now_us));
    }
    if (has_sample_counter(machine_.can)) {
        put_status(status_of(desk, phase, now_us), now_us, outbox);
    }
}

/// Every 100 ms, and after a change; at most one every kOperatorStatusUsMin.
void Announcements::put_status(OperatorStatus status, std::int64_t now_us,
                               Outbox& outbox) noexcept {
    const bool has_changed = !is_same(status, status_);
    status_due_us_ = status_us_ + (has_changed ? kOperatorStatusUsMin : kOperatorStatusUs);
    if (now_us < status_due_us_) {
        return;
    }
    status.counter = static_cast<std::uint8_t>((status_.counter + 1U) & 15U);
    status_ = status;
    status_us_ = now_us;
    status_due_us_ = now_us + kOperatorStatusUs;
    outbox.put_status(encode_operator_status(machine_.can, status, now_us));
}

std::int64_t Announcements::next_due_us() const noexcept {
    return std::min({heartbeat_us_, handshake_.next_due_us(), status_due_us_});
}

}  // namespace axg
