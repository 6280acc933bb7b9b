// SPDX-License-Identifier: Apache-2.0
// A guard without geometry: every coherent snapshot is certified. For tests and times of the board.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "core/guard/monitor.hpp"
#include "core/machine/machine.hpp"
#include "firmware_if/protocol/guard_frames.hpp"
#include "firmware_if/receiver/axis_receiver.hpp"
#include "hil_replay/board/closed_loop.hpp"

namespace axg::test {

class PermitGuard {
  public:
    /// @param response_us  from the last frame of a sample to the permit
    PermitGuard(const Machine& machine, std::int64_t response_us)
        : receiver_(machine), layout_(machine.can), response_us_(response_us) {}

    void on_frame(const CanFrame& frame, std::vector<CanFrame>& sent) {
        answer(receiver_.on_frame(frame), sent);
    }
    void on_time(std::int64_t now_us, std::vector<CanFrame>& sent) {
        answer(receiver_.on_time(now_us), sent);
    }

  private:
    void answer(const ReceiverEvent& event, std::vector<CanFrame>& sent) {
        if (event.kind == ReceiverEvent::Kind::snapshot) {
            Permit permit;
            const bool is_valid = event.state == ReceiverState::valid;
            permit.word = is_valid ? PermitWord::run : PermitWord::stop;
            permit.sync_counter = event.sync_counter;
            permit.live_counter = ++live_counter_;
            permit.known_answer_signature = kKnownAnswerSignature;
            for (const CanFrame& frame :
                 encode_permit(layout_, permit, event.time_us + response_us_)) {
                sent.push_back(frame);
            }
        } else if (event.kind == ReceiverEvent::Kind::fault && event.severity == Severity::stop) {
            sent.push_back(encode_stop(layout_, event.time_us));
        }
    }

    AxisReceiver receiver_;
    CanLayout layout_;
    std::int64_t response_us_;
    std::uint8_t live_counter_ = 0;
};

inline LoopGuard make_permit_guard(const Machine& machine, std::int64_t response_us) {
    const auto guard = std::make_shared<PermitGuard>(machine, response_us);
    return {[guard](const CanFrame& frame, std::vector<CanFrame>& sent) {
                guard->on_frame(frame, sent);
            },
            [guard](std::int64_t now_us, std::vector<CanFrame>& sent) {
                guard->on_time(now_us, sent);
            }};
}

}  // namespace axg::test
