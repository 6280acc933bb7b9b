// SPDX-License-Identifier: Apache-2.0
// Requests and confirmations of reset and arm by operator frames: which request waits, with
// which nonce, and whether a message acts. Pure: what the guard would say to the action is passed
// in, and the caller acts. Source: docs/reference/board.md, "An operator's reset and arm".
#pragma once

#include <cstdint>

#include "firmware_if/protocol/operator_frames.hpp"

namespace axg {

inline constexpr std::int64_t kOperatorConfirmUs = 5'000'000;  // from the request
inline constexpr std::int64_t kOperatorStatusUs = 100'000;     // between two statuses, at most
// A status that changes with every message of a sender gone wild does not keep the bus busy.
inline constexpr std::int64_t kOperatorStatusUsMin = 10'000;

// Kinds of lines about messages: one of each refusal, and two of what was ignored.
inline constexpr std::uint32_t kOperatorNotes = kOperatorRefusals + 2;

struct OperatorDesk {
    bool has_counter = false;
    std::uint8_t counter = 0;  // of the last message
    // The newest request that no confirmation has used up; also when it is too old.
    OperatorAction asked = OperatorAction::none;
    std::uint32_t nonce = 0;
    std::int64_t asked_us = 0;
    OperatorRefusal refusal = OperatorRefusal::none;  // of the last message that was judged
};

/// What a message came to.
enum class OperatorHearing : std::uint8_t {
    ignored,    // its counter did not advance by 1: nothing but the counter is remembered
    asked,      // a request: a nonce was drawn
    confirmed,  // the caller acts now
    refused,    // OperatorDesk::refusal says why
};

/// @param hindrance  why the guard would not do that action now; none: it would
[[nodiscard]] OperatorHearing hear(OperatorDesk& desk, const OperatorMessage& message,
                                   OperatorRefusal hindrance, std::int64_t now_us) noexcept;

/// The phase has changed: a request was for the one before.
void forget_request(OperatorDesk& desk) noexcept;

[[nodiscard]] bool has_request(const OperatorDesk& desk, std::int64_t now_us) noexcept;

/// Without its counter.
[[nodiscard]] OperatorStatus status_of(const OperatorDesk& desk, GuardPhase phase,
                                       std::int64_t now_us) noexcept;

/// 24 bits, never 0 and never `last`. Of the clock, so that a black box draws the same again: it is
/// against accidents, such as a recording that is played, and no secret.
[[nodiscard]] std::uint32_t draw_nonce(std::int64_t now_us, std::uint32_t last) noexcept;

}  // namespace axg
