// SPDX-License-Identifier: Apache-2.0
// Requests and confirmations of reset and arm by operator frames: which request waits, with
// which nonce, and whether a message acts. Pure: the caller passes in the guard's hindrance of the
// action, and acts. Source: docs/reference/board.md, "An operator's reset and arm".
#pragma once

#include <cstdint>

#include "firmware_if/protocol/operator_frames.hpp"

namespace axg {

inline constexpr std::int64_t kOperatorConfirmUs = 5'000'000;  // from the request
inline constexpr std::int64_t kOperatorStatusUs = 100'000;     // between two statuses, at most
// Least time between two: a faulty sender that changes the status often does not load the bus.
inline constexpr std::int64_t kOperatorStatusUsMin = 10'000;

// Kinds of lines about messages: one of each refusal, and two of ignored messages.
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

/// Result of a message.
enum class OperatorHearing : std::uint8_t {
    ignored,    // its counter did not advance by 1: only the counter is stored
    asked,      // a request: a nonce was drawn
    confirmed,  // the caller acts now
    refused,    // for the reason OperatorDesk::refusal
};

/// @param hindrance  why the guard would not do that action now; none: it would
[[nodiscard]] OperatorHearing hear(OperatorDesk& desk, const OperatorMessage& message,
                                   OperatorRefusal hindrance, std::int64_t now_us) noexcept;

/// Discards the request when the phase has changed: it was for the phase before.
void forget_request(OperatorDesk& desk) noexcept;

[[nodiscard]] bool has_request(const OperatorDesk& desk, std::int64_t now_us) noexcept;

/// Without its counter.
[[nodiscard]] OperatorStatus status_of(const OperatorDesk& desk, GuardPhase phase,
                                       std::int64_t now_us) noexcept;

/// 24 bits, never 0 and never `last`. Computed from the clock, so that a replay draws the same. It
/// protects against accidents, such as a recording played on the bus, and is no secret.
[[nodiscard]] std::uint32_t draw_nonce(std::int64_t now_us, std::uint32_t last) noexcept;

}  // namespace axg
