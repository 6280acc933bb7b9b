// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/drive/drive_guard.hpp"

namespace axg {

DriveGuard::DriveGuard(GuardChain& chain, const CanLayout& layout, std::int64_t response_us)
    : chain_(chain),
      response_us_(response_us),
      sender_(layout, [this](const CanFrame& frame) { sent_->push_back(frame); }) {}

GuardNode DriveGuard::node() {
    return {[this](const CanFrame& frame, std::vector<CanFrame>& sent) {
                sent_ = &sent;
                on_event(chain_.receive(frame));
            },
            [this](std::int64_t now_us, std::vector<CanFrame>& sent) {
                sent_ = &sent;
                sender_.send_due(now_us);
                on_event(chain_.on_time(now_us));
            }};
}

void DriveGuard::on_event(const ReceiverEvent& event) {
    const bool is_fault =
        event.kind == ReceiverEvent::Kind::fault && event.severity == Severity::stop;
    if (event.kind == ReceiverEvent::Kind::snapshot) {
        chain_.evaluate();
        result_ = chain_.decide(event.state == ReceiverState::valid);
        sender_.on_cycle(result_, chain_.state().live_counter, event.sync_counter,
                         event.snapshot.arrived_us + response_us_);
        chain_.update_advisories();
    } else if (is_fault) {
        result_ = chain_.lose_input();
        sender_.on_input_lost(event.time_us + response_us_);
    }
    if (result_.stops_now && stop_.reason == StopReason::none) {
        stop_ = {result_.reason, result_.pair, is_fault ? event.fault : ReceiverFault::none,
                 chain_.snapshot()};
    }
}

}  // namespace axg
