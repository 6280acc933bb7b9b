// SPDX-License-Identifier: Apache-2.0
// A guard without geometry: every coherent snapshot is certified. For tests and times of the board.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "core/guard/monitor.hpp"
#include "core/machine/machine.hpp"
#include "firmware_if/protocol/guard_frames.hpp"
#include "firmware_if/protocol/handshake.hpp"
#include "firmware_if/protocol/permit_frames.hpp"
#include "firmware_if/receiver/axis_receiver.hpp"
#include "hil_replay/board/closed_loop.hpp"

namespace axg::test {

class PermitGuard {
  public:
    /// @param response_us  from the last frame of a sample to the permit
    /// @param hashes  that it says with its first sample, where the layout has their ids
    PermitGuard(const Machine& machine, std::int64_t response_us, ConfigurationHashes hashes = {})
        : receiver_(machine), layout_(machine.can), response_us_(response_us), hashes_(hashes) {}

    void on_frame(const CanFrame& frame, std::vector<CanFrame>& sent) {
        answer(receiver_.on_frame(frame), sent);
    }
    void on_time(std::int64_t now_us, std::vector<CanFrame>& sent) {
        answer(receiver_.on_time(now_us), sent);
    }

  private:
    void answer(const ReceiverEvent& event, std::vector<CanFrame>& sent) {
        const bool has_stopped =
            event.kind == ReceiverEvent::Kind::fault && event.severity == Severity::stop;
        if (event.kind == ReceiverEvent::Kind::snapshot) {
            say_hashes(event.time_us, sent);
            permit(event, sent);
        } else if (has_stopped) {
            sent.push_back(encode_stop(layout_, event.time_us));
        }
    }
    void say_hashes(std::int64_t now_us, std::vector<CanFrame>& sent) {
        for (std::uint8_t part = 0; layout_.hashes_out_id != 0 && !has_hashes_said_ && part < 4;
             ++part) {
            sent.push_back(encode_hash(layout_.hashes_out_id, {part, hashes_.of[part]}, now_us));
        }
        has_hashes_said_ = true;
    }
    void permit(const ReceiverEvent& event, std::vector<CanFrame>& sent) {
        const auto session = receiver_.session_of(event.sync_counter);
        if (!session || event.state != ReceiverState::valid) {
            return;
        }
        const Permit made{.word = PermitWord::run,
                          .sync_counter = event.sync_counter,
                          .live_counter = ++live_counter_,
                          .known_answer_signature = kKnownAnswerSignature,
                          .samples = layout_.permit_samples.most,
                          .nonce = session->nonce,
                          .lap = session->lap};
        for (const CanFrame& frame : encode_permit(layout_, made, event.time_us + response_us_)) {
            sent.push_back(frame);
        }
    }

    AxisReceiver receiver_;
    CanLayout layout_;
    std::int64_t response_us_;
    ConfigurationHashes hashes_;
    std::uint8_t live_counter_ = 0;
    bool has_hashes_said_ = false;
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
