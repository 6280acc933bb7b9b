// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/guard/permit_issue.hpp"

#include <algorithm>

#include "core/guard/cap_guard.hpp"

namespace axg {

PermitIssue::PermitIssue(const Machine& machine, const AxisReceiver& receiver) noexcept
    : machine_(machine), receiver_(receiver), age_samples_(age_samples(machine)) {}

CapFacts PermitIssue::note_sample(const ReceiverEvent& event) noexcept {
    return keeps_cap()
               ? ledger_.note_sample(acked_permit(event.snapshot), event.samples_lost, age_samples_)
               : CapFacts{};
}

void PermitIssue::answer(Permit& permit) const noexcept {
    const SampleSession session =
        receiver_.session_of(permit.sync_counter).value_or(SampleSession{});
    permit.nonce = session.nonce;
    permit.lap = session.lap;
}

Permit PermitIssue::issue(const LiveResult& result) noexcept {
    Permit permit = permit_of(result.result, ++live_counter_, result.sync_counter);
    answer(permit);
    if (keeps_cap()) {  // a jog has none
        const bool has_cap = permit.word != PermitWord::jog;
        ledger_.note_sent(live_counter_,
                          has_cap ? caps_of_permit(permit.cap, permit.mask) : rapid_caps());
    }
    return permit;
}

Permit PermitIssue::stop_word() noexcept {
    Permit permit{.word = PermitWord::stop,
                  .sync_counter = std::max<std::uint8_t>(receiver_.newest_sync_counter(), 1),
                  .live_counter = ++live_counter_,
                  .known_answer_signature = kKnownAnswerSignature};
    answer(permit);
    return permit;
}

std::optional<std::uint32_t> PermitIssue::newest_nonce() const noexcept {
    const std::optional<SampleSession> session =
        receiver_.session_of(receiver_.newest_sync_counter());
    return session ? std::optional(session->nonce) : std::nullopt;
}

bool PermitIssue::waits_for_board() const noexcept {
    const std::optional<std::uint32_t> nonce = newest_nonce();
    return own_stop_.is_on && has_sample_counter(machine_.can) &&
           (!nonce || nonce == own_stop_.nonce);
}

}  // namespace axg
