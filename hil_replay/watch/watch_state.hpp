// SPDX-License-Identifier: Apache-2.0
// One state of the live page: guard, board and machine at one instant, and the headline that a
// person reads first; as JSON for the page.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/machine/machine.hpp"
#include "hil_replay/watch/bus_view.hpp"

namespace axg {

// A guard beats every 10 ms, also while it is stopped; its status is read five times a second.
inline constexpr std::int64_t kGuardSilentUs = 250'000;
inline constexpr std::int64_t kStatusOldUs = 2'500'000;
inline constexpr std::int64_t kStatusEveryUs = 200'000;

/// The line of the status socket, read and checked.
struct GuardLine {
    std::string phase, cause, reason, withheld, withheld_reason;  // names; "none", "nothing"
    std::string pair, withheld_pair;                              // "a - b"; empty: none
    std::string why, withheld_why;  // JSON, as the line has them; empty, "null": unknown
    std::string bus, machine, configuration, version, mode;
    std::vector<std::string> ways_out;  // of a stop, as StatusWords has them
    std::uint64_t program_line = 0;     // of the control, at the stop; 0: not reported
    bool has_view = false;              // the keys of a guard whose bus thread turns
    bool stands = false, is_confirmed = false;
    std::uint64_t age_ms = 0, phase_ms = 0, permits = 0, samples = 0, late = 0, lost = 0;
};
/// "a - b", as the status line has it.
[[nodiscard]] std::string words_of_pair(const Machine& machine, std::uint32_t pair);

/// nullopt: no line of this version.
[[nodiscard]] std::optional<GuardLine> read_guard_line(std::string_view line);

/// What a page says of a recorded bus.
struct WatchedTraces {
    bool has_guard = true;           // some frame is the guard's
    bool is_over = false;            // they were played to their end
    std::vector<std::string> notes;  // what is missing in them
};

struct WatchInput {
    const Machine& machine;
    std::string_view configuration;  // hash of the machine file that the page shows
    const BusState* bus = nullptr;   // null: the bus is not read
    std::string_view bus_name = {};
    std::string_view bus_fault = {};        // why it cannot be read now; empty: it can
    const WatchedTraces* traces = nullptr;  // null: the bus is no recorded one
    bool reads_status = false;
    std::optional<GuardLine> status{};    // of the last line that was read
    std::int64_t status_us = kNeverSeen;  // when
    std::string_view status_fault = {};   // why the last reading failed; empty: it did not
    std::int64_t now_us = 0;
    std::uint64_t number = 0;  // of this state
};

/// The state in a word, for colours and marks: "armed", "ready", "selftest", "init", "running",
/// "stopped", "unreachable".
struct WatchHeadline {
    std::string kind, text;
    std::optional<std::int64_t> since_ms;
};
[[nodiscard]] WatchHeadline headline_of(const WatchInput& input);

/// Further warnings for a person: machine files that differ, a bus that is down, garbage.
[[nodiscard]] std::vector<std::string> notes_of(const WatchInput& input);

/// A stop or a withheld permit that the page explains by distances.
struct WatchWhy {
    std::string of;         // "stop", "permit withheld"
    std::string pair;       // empty: unknown
    std::string distances;  // JSON, as the line has it; empty: unknown
    std::string words;      // why there are no distances; empty: there are
    std::vector<std::string> ways_out = {};
};
/// Empty without a stop or a withheld permit, or if the status line names neither pair nor way out.
[[nodiscard]] std::vector<WatchWhy> whys_of(const WatchInput& input);

/// In ASCII, one line.
[[nodiscard]] std::string watch_json(const WatchInput& input);

}  // namespace axg
