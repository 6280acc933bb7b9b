// SPDX-License-Identifier: Apache-2.0
// A person's reset and arm, by call and by frames, and the status that reports them.
#include <algorithm>

#include "firmware_if/guard/guard_node.hpp"

namespace axg {
namespace {

constexpr std::uint32_t kNoMessage = kOperatorRefusals, kNoCounter = kOperatorRefusals + 1;
static_assert(kNoCounter < kOperatorNotes);

const char* words_of(OperatorAction action, OperatorRefusal refusal) noexcept {
    const bool is_arm = action == OperatorAction::arm;
    switch (refusal) {
        case OperatorRefusal::moves:
            return is_arm ? "arm: the axes are not at rest" : "reset: the axes are not yet at rest";
        case OperatorRefusal::cause:
            return "reset: a fault is still present";
        case OperatorRefusal::phase:
            return is_arm ? "arm: the guard is not ready" : "reset: nothing is latched";
        case OperatorRefusal::nonce:
            return is_arm ? "arm: confirmed with a wrong nonce"
                          : "reset: confirmed with a wrong nonce";
        case OperatorRefusal::too_late:
            return is_arm ? "arm: confirmed later than 5 s" : "reset: confirmed later than 5 s";
        case OperatorRefusal::board:
            return "arm: the board stopped by itself and has the nonce of then: arm the board "
                   "first";
        case OperatorRefusal::none:
            break;
    }
    return "";
}

bool is_same(const OperatorStatus& a, const OperatorStatus& b) noexcept {
    return a.phase == b.phase && a.action == b.action && a.refusal == b.refusal &&
           a.nonce == b.nonce;
}

}  // namespace

void GuardNode::arm(std::int64_t now_us) noexcept {
    wire_.set_time(now_us);
    wire_.add(LiveCall{.kind = LiveCall::Kind::arm});
    const OperatorRefusal refusal = hindrance_of(OperatorAction::arm, now_us);
    if (refusal == OperatorRefusal::none) {
        own_stop_.is_on = false;
        on({.kind = GuardEventKind::arm}, now_us);
    } else if (guard_.phase != GuardPhase::armed) {
        note({.kind = LiveNote::Kind::refused, .words = words_of(OperatorAction::arm, refusal)},
             now_us);
    }
}

void GuardNode::reset(std::int64_t now_us) noexcept {
    wire_.set_time(now_us);
    wire_.add(LiveCall{.kind = LiveCall::Kind::reset});
    const OperatorRefusal refusal = hindrance_of(OperatorAction::reset, now_us);
    if (refusal == OperatorRefusal::none) {
        on({.kind = GuardEventKind::reset_edge}, now_us);
    } else {
        note({.kind = LiveNote::Kind::refused, .words = words_of(OperatorAction::reset, refusal)},
             now_us);
    }
}

/// The reason why that action would have no effect now; none: it would have one.
OperatorRefusal GuardNode::hindrance_of(OperatorAction action, std::int64_t now_us) noexcept {
    if (action == OperatorAction::arm) {
        const bool may_move = supposes_arming_ && !own_stop_.is_on;
        return guard_.phase != GuardPhase::ready          ? OperatorRefusal::phase
               : !may_move && !standstill_.stands(now_us) ? OperatorRefusal::moves
               : waits_for_board()                        ? OperatorRefusal::board
                                                          : OperatorRefusal::none;
    }
    if (guard_.phase != GuardPhase::stopped) {
        return OperatorRefusal::phase;
    }
    check_standstill(now_us);
    if (!guard_.is_confirmed) {
        return OperatorRefusal::moves;
    }
    Guard tried = guard_;
    static_cast<void>(on_event(tried, {.kind = GuardEventKind::reset_edge}, limits_));
    return tried.phase == GuardPhase::stopped ? OperatorRefusal::cause : OperatorRefusal::none;
}

void GuardNode::on_operator(const CanFrame& frame, std::int64_t now_us) noexcept {
    OperatorMessage message;
    if (decode_operator_message(machine_.can, frame, message) != FrameStatus::ok) {
        ++counters_.operator_ignored;
        note_operator(kNoMessage, "a frame that is not an operator message", now_us);
        return;
    }
    const OperatorRefusal hindrance = hindrance_of(message.action, now_us);
    switch (hear(operator_, message, hindrance, now_us)) {
        case OperatorHearing::ignored:
            ++counters_.operator_ignored;
            note_operator(kNoCounter, "an operator message whose counter did not advance by 1",
                          now_us);
            break;
        case OperatorHearing::refused:
            ++counters_.operator_refused;
            note_operator(static_cast<std::uint32_t>(operator_.refusal),
                          words_of(message.action, operator_.refusal), now_us);
            break;
        case OperatorHearing::asked:
            break;
        case OperatorHearing::confirmed: {
            ++counters_.operator_acts;
            const bool is_arm = message.action == OperatorAction::arm;
            note({.kind = LiveNote::Kind::person,
                  .frame_id = frame.id,
                  .words = is_arm ? "an operator arms" : "an operator resets"},
                 now_us);
            own_stop_.is_on = own_stop_.is_on && !is_arm;
            on({.kind = is_arm ? GuardEventKind::arm : GuardEventKind::reset_edge}, now_us);
            break;
        }
    }
}

/// Logs at most one line a second of each kind.
void GuardNode::note_operator(std::uint32_t kind, const char* words, std::int64_t now_us) noexcept {
    if (now_us < operator_note_us_[kind]) {
        return;
    }
    operator_note_us_[kind] = now_us + kNoteUs;
    note({.kind = LiveNote::Kind::refused, .frame_id = machine_.can.operator_in_id, .words = words},
         now_us);
}

/// Every 100 ms, and after a change; at most one every kOperatorStatusUsMin.
void GuardNode::send_status(std::int64_t now_us) noexcept {
    if (!has_sample_counter(machine_.can)) {
        return;
    }
    OperatorStatus status = status_of(operator_, guard_.phase, now_us);
    const bool has_changed = !is_same(status, status_);
    status_due_us_ = status_us_ + (has_changed ? kOperatorStatusUsMin : kOperatorStatusUs);
    if (now_us < status_due_us_) {
        return;
    }
    status.counter = static_cast<std::uint8_t>((status_.counter + 1U) & 15U);
    status_ = status;
    status_us_ = now_us;
    status_due_us_ = now_us + kOperatorStatusUs;
    outbox_.put_status(encode_operator_status(machine_.can, status, now_us));
}

}  // namespace axg
