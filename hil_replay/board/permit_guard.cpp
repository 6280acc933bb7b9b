// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/board/permit_guard.hpp"

#include <memory>

#include "core/guard/monitor.hpp"
#include "firmware_if/protocol/guard_frames.hpp"
#include "firmware_if/receiver/axis_receiver.hpp"

namespace axg {

namespace {

struct State {
    AxisReceiver receiver;
    CanLayout layout;
    std::uint8_t live_counter = 0;
};

void answer(State& state, const ReceiverEvent& event, std::int64_t response_us,
            std::vector<CanFrame>& sent) {
    if (event.kind == ReceiverEvent::Kind::snapshot) {
        Permit permit;
        const bool is_valid = event.state == ReceiverState::valid;
        permit.word = is_valid ? PermitWord::run : PermitWord::stop;
        permit.sync_counter = event.sync_counter;
        permit.live_counter = ++state.live_counter;
        permit.known_answer_signature = kKnownAnswerSignature;
        for (const CanFrame& frame :
             encode_permit(state.layout, permit, event.time_us + response_us)) {
            sent.push_back(frame);
        }
    } else if (event.kind == ReceiverEvent::Kind::fault && event.severity == Severity::stop) {
        sent.push_back(encode_stop(state.layout, event.time_us));
    }
}

}  // namespace

GuardNode make_permit_guard(const Machine& machine, std::int64_t response_us) {
    const auto state = std::make_shared<State>(State{AxisReceiver(machine), machine.can, 0});
    return {[state, response_us](const CanFrame& frame, std::vector<CanFrame>& sent) {
                answer(*state, state->receiver.on_frame(frame), response_us, sent);
            },
            [state, response_us](std::int64_t now_us, std::vector<CanFrame>& sent) {
                answer(*state, state->receiver.on_time(now_us), response_us, sent);
            }};
}

}  // namespace axg
