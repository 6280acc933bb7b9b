// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/guard/operator_desk.hpp"

namespace axg {
namespace {

constexpr std::uint32_t kNonceMask = 0xFFFFFF;

/// Checks that a confirmation matches the request and is in time.
OperatorRefusal judge_confirmation(const OperatorDesk& desk, const OperatorMessage& message,
                                   std::int64_t now_us) noexcept {
    if (desk.asked != message.action || desk.nonce != message.nonce) {
        return OperatorRefusal::nonce;
    }
    return has_request(desk, now_us) ? OperatorRefusal::none : OperatorRefusal::too_late;
}

}  // namespace

OperatorHearing hear(OperatorDesk& desk, const OperatorMessage& message, OperatorRefusal hindrance,
                     std::int64_t now_us) noexcept {
    const bool is_next = !desk.has_counter || message.counter == ((desk.counter + 1U) & 15U);
    desk.has_counter = true;
    desk.counter = message.counter;
    if (!is_next) {
        return OperatorHearing::ignored;
    }
    const bool is_confirmation = message.step == OperatorStep::confirm;
    desk.refusal = hindrance != OperatorRefusal::none ? hindrance
                   : is_confirmation                  ? judge_confirmation(desk, message, now_us)
                                                      : OperatorRefusal::none;
    const std::uint32_t last = desk.nonce;
    forget_request(desk);  // each message uses the nonce up, right or wrong
    if (desk.refusal != OperatorRefusal::none) {
        return OperatorHearing::refused;
    }
    if (is_confirmation) {
        return OperatorHearing::confirmed;
    }
    desk.asked = message.action;
    desk.nonce = draw_nonce(now_us, last);
    desk.asked_us = now_us;
    return OperatorHearing::asked;
}

void forget_request(OperatorDesk& desk) noexcept {
    desk.asked = OperatorAction::none;
}

bool has_request(const OperatorDesk& desk, std::int64_t now_us) noexcept {
    return desk.asked != OperatorAction::none && now_us - desk.asked_us <= kOperatorConfirmUs;
}

OperatorStatus status_of(const OperatorDesk& desk, GuardPhase phase, std::int64_t now_us) noexcept {
    const bool waits = has_request(desk, now_us);
    return {.phase = phase,
            .action = waits ? desk.asked : OperatorAction::none,
            .refusal = desk.refusal,
            .nonce = waits ? desk.nonce : 0};
}

std::uint32_t draw_nonce(std::int64_t now_us, std::uint32_t last) noexcept {
    // Every bit of the instant moves every bit: the last step of splitmix64 (public domain).
    std::uint64_t mixed = static_cast<std::uint64_t>(now_us) + 0x9E3779B97F4A7C15U;
    mixed = (mixed ^ (mixed >> 30U)) * 0xBF58476D1CE4E5B9U;
    mixed = (mixed ^ (mixed >> 27U)) * 0x94D049BB133111EBU;
    auto nonce = static_cast<std::uint32_t>((mixed ^ (mixed >> 31U)) & kNonceMask);
    while (nonce == 0 || nonce == last) {
        nonce = (nonce + 1) & kNonceMask;
    }
    return nonce;
}

}  // namespace axg
