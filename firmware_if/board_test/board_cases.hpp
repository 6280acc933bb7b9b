// SPDX-License-Identifier: Apache-2.0
// Test cases of a board, one fault a case, and every rule of docs/reference/board.md that a case or
// a watch over the whole test judges. Data only: board_player.hpp plays it.
#pragma once

#include <cstdint>
#include <span>

#include "firmware_if/board_test/permit_edit.hpp"

namespace axg {

enum class CaseStart : std::uint8_t {
    moving = 0,  // armed, and at a steady speed with good permits
    resting,     // armed, and without a permit yet
    jogging,     // as moving, in a jog
};

enum class CaseEvent : std::uint8_t {
    none = 0,
    stop_frame,
    long_stop_frame,  // of 8 bytes
    stop_word,
    other_hash,
};

/// Reaction that the board must then show.
enum class CaseDemand : std::uint8_t {
    brakes_at_end = 0,  // from the end of the last good permit
    brakes_at_once,     // from the event
    rests,              // until the permits are good again
    goes_on,
    slows,  // below the cap, and acknowledges it
    holds,  // rests under cap 0, and continues without a person
};

enum class CaseNeed : std::uint8_t { nothing = 0, jog, cap, hashes, more_samples, samples_above };

struct BoardCase {
    const char* name;
    int rule;             // of docs/reference/board.md
    const char* demands;  // one clause
    const char* mend;     // what to look at when it fails
    CaseStart start = CaseStart::moving;
    CaseDemand demand = CaseDemand::brakes_at_end;
    PermitEdit edit{};
    CaseEvent event = CaseEvent::none;
    CaseNeed need = CaseNeed::nothing;
    std::int32_t samples_before = -1;  // n of the good permits; below 0: the machine file's
};

/// In the order in which they are played; the first two are played whatever is chosen.
[[nodiscard]] std::span<const BoardCase> board_cases() noexcept;
inline constexpr std::size_t kFirstCases = 2;  // run and lapse: the others depend on them

/// Judged in every case, or by no case.
struct WatchedRule {
    const char* name;
    int rule;
    const char* demands;
    const char* mend;
};
enum class Watched : std::uint8_t {
    samples = 0,
    session,
    braking,
    resume,
    new_nonce,
    hash_answers,
    mode,
    ack,
    tool_change,
    count
};
[[nodiscard]] const WatchedRule& watched_rule(Watched watched) noexcept;

/// A rule that no frame shows on a bench.
struct UnseenRule {
    const char* name;
    int rule;
    const char* why;
};
[[nodiscard]] std::span<const UnseenRule> unseen_rules() noexcept;

}  // namespace axg
