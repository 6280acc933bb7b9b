// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/drive/drive_guard.hpp"

#include <algorithm>

namespace axg {

DriveGuard::DriveGuard(const Machine& machine, GuardChain& chain, const ConfigurationHashes& hashes,
                       std::int64_t response_us, std::int64_t now_us, std::int64_t killed_us)
    : chain_(chain),
      sends_sync_(machine.can.guard_sends_sync),
      killed_us_(killed_us),
      sent_(&first_),
      guard_({.machine = machine, .chain = chain},
             {.guard = {.hashes = hashes},
              .echoes = false,
              .answers_hashes = false,
              .sent = [this](const CanFrame& frame) { sent_->push_back(frame); },
              .response_us = [response_us](std::int64_t) { return response_us; },
              .each =
                  [this](const TimedCycle& cycle) {
                      result_ = cycle.result.result;
                      has_permit_ = cycle.sent_permit;
                  }},
             now_us) {}

void DriveGuard::take_wire(std::vector<CanFrame>& sent) {
    sent.insert(sent.end(), first_.begin(), first_.end());
    first_.clear();
    sent_ = &sent;
}

LoopGuard DriveGuard::node() {
    const auto hear = [this](const CanArrival& arrival, std::vector<CanFrame>& sent) {
        if (arrival.frame.time_us >= killed_us_) {
            return;
        }
        take_wire(sent);
        guard_.arrive(arrival);
        note_stop();
    };
    return {.on_frame = [hear](const CanFrame& frame,
                               std::vector<CanFrame>& sent) { hear({.frame = frame}, sent); },
            .on_time =
                [this](std::int64_t now_us, std::vector<CanFrame>& sent) {
                    if (sends_sync_) {  // no frame of the board precedes its own
                        take_wire(sent);
                    }
                    sent_ = &sent;
                    guard_.run_before(std::min(now_us + 1, killed_us_));
                    note_stop();
                },
            .on_echo =
                [hear](const CanFrame& frame, std::vector<CanFrame>& sent) {
                    hear({.frame = frame, .is_own = true}, sent);
                },
            .next_due_us =
                [this] {
                    const std::int64_t due_us = guard_.next_due_us();
                    return due_us < killed_us_ ? due_us : INT64_MAX;
                }};
}

void DriveGuard::note_stop() {
    if (!guard_.is_stopped() || stop_.cause != GuardFault::none) {
        return;
    }
    const GuardNode& live = guard_.guard();
    stop_ = {.cause = live.guard().cause,
             .reason = live.reason(),
             .pair = live.pair(),
             .fault = live.receiver().stop_cause(),
             .limit = result_.limit,
             .cap = result_.cap_fact,
             .snapshot = chain_.snapshot(),
             .unproven = chain_.unproven(live.pair())};
}

}  // namespace axg
