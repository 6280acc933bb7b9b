// SPDX-License-Identifier: Apache-2.0
// The permits of the guard node, and the board's session that they name.
#include <algorithm>

#include "firmware_if/guard/guard_node.hpp"

namespace axg {
namespace {

constexpr std::int64_t kSessionNoteUs = 1'000'000;

}  // namespace

void GuardNode::send_permit(const LiveResult& live_result, std::int64_t now_us) noexcept {
    const CanLayout& can = machine_.can;
    const std::uint8_t echo = live_result.sync_counter;
    Permit permit = permit_of(live_result.result, ++live_counter_, echo);
    if (has_sample_counter(can)) {
        const SampleSession session = receiver_.session_of(echo).value_or(SampleSession{});
        permit.nonce = session.nonce;
        permit.lap = session.lap;
        if (keeps_cap()) {  // a jog has none
            const bool has_cap = permit.word != PermitWord::jog;
            ledger_.note_sent(live_counter_,
                              has_cap ? caps_of_permit(permit.cap, permit.mask) : rapid_caps());
        }
        outbox_.put_permit(encode_permit(can, permit, now_us));
    }
    ++counters_.permits;
    counters_.slow += permit.word == PermitWord::slow ? 1U : 0U;
    set_line(!line_level_, now_us);
}

/// For a board that does not obey the stop frame. The board checks only the word and the twin: a
/// guard without input has no sample to echo.
void GuardNode::put_stop_word(std::int64_t now_us) noexcept {
    const std::uint8_t echo = std::max<std::uint8_t>(receiver_.newest_sync_counter(), 1);
    const SampleSession session = receiver_.session_of(echo).value_or(SampleSession{});
    outbox_.put_stop_word(encode_permit(machine_.can,
                                        {.word = PermitWord::stop,
                                         .sync_counter = echo,
                                         .live_counter = ++live_counter_,
                                         .known_answer_signature = kKnownAnswerSignature,
                                         .nonce = session.nonce,
                                         .lap = session.lap},
                                        now_us));
}

/// The board waits on its path, with permits and without a stop, until a crawl is proven. Informs
/// the person, because that may never happen.
void GuardNode::note_held(const CycleResult& result, std::int64_t now_us) noexcept {
    if (result.is_held && !is_held_) {
        note({.kind = LiveNote::Kind::wire,
              .words = "held by the cap for 2 s: not even a crawl is proven; jog the axes away, or "
                       "change the program"},
             now_us);
    }
    is_held_ = result.is_held;
}

std::optional<std::uint32_t> GuardNode::newest_nonce() const noexcept {
    const std::optional<SampleSession> session =
        receiver_.session_of(receiver_.newest_sync_counter());
    return session ? std::optional(session->nonce) : std::nullopt;
}

/// A board that stops by itself latches: a person arms it, which draws a new nonce. Until then no
/// person has checked the cause, which may be a frozen encoder.
void GuardNode::note_own_stop() noexcept {
    own_stop_ = {.is_on = true, .nonce = newest_nonce()};
}

bool GuardNode::waits_for_board() const noexcept {
    const std::optional<std::uint32_t> nonce = newest_nonce();
    return own_stop_.is_on && has_sample_counter(machine_.can) &&
           (!nonce || nonce == own_stop_.nonce);
}

/// The CRC of a permit covers the board's nonce and the sample's lap: the board would
/// refuse a permit without them. Logged once a second.
bool GuardNode::lacks_session(const LiveResult& live_result, std::int64_t now_us) noexcept {
    if (!has_sample_counter(machine_.can)) {
        return false;
    }
    if (receiver_.session_of(live_result.sync_counter)) {
        next_session_note_us_ = now_us;  // a missing session is then logged at once
        return false;
    }
    if (now_us >= next_session_note_us_) {
        next_session_note_us_ = now_us + kSessionNoteUs;
        note({.kind = LiveNote::Kind::wire,
              .frame_id = machine_.can.session_in_id,
              .words = "no session frame of the board for 300 ms: no permit"},
             now_us);
    }
    return true;
}

}  // namespace axg
