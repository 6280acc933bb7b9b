// SPDX-License-Identifier: Apache-2.0
// Why a pair was not proven, and why a guard is stopped, as plain sentences. One wording for
// reports, pages, logs and the status of a running guard; lists and parts of a distance are details
// that each of them adds.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/guard/guard_state.hpp"

namespace axg {

/// How much of a report is printed: one screen, or all of it.
enum class Detail : std::uint8_t { brief, full };

enum class WhyCause : std::uint8_t {
    margin,      // contact mode: the pair is nearer than its margin
    contained,   // one body is inside the other: no distance is enough
    reach,       // a position in the reach is nearer than the margin
    halving,     // a larger plan proves it: halving was not finished
    shared,      // by itself it is proven: the lists of the cycle were shared
    capacity,    // a list of the engine was full
    not_known,   // the motion was not sufficiently determined: no query
    not_proven,  // none of these was found
};
[[nodiscard]] const char* to_text(WhyCause cause) noexcept;

struct WhyFacts {
    WhyCause cause = WhyCause::not_proven;
    std::string a, b;         // names of the bodies for the reader
    bool is_of_stop = true;   // false: of the sampled pose alone
    double available_mm = 0;  // certified lower bound of the distance; 0: none
    double needed_mm = 0;     // at most, by the proof of a stop
    double margin_mm = 0;     // of the pair
};

/// One or two sentences: the missing proof; then the distance, if the cause is about one.
[[nodiscard]] std::vector<std::string> why_sentences(const WhyFacts& facts);

/// What leads out of a stop with an unknown tool.
inline constexpr std::string_view kUnknownToolWay =
    "add it under tools; load another tool to go on";

/// "tool 3 is not in m.yaml: ..."
[[nodiscard]] std::string unknown_tool_sentence(std::uint64_t tool, std::string_view file);

/// A stop in force, as its reader sees it.
struct StopAccount {
    GuardFault cause = GuardFault::none;
    StopReason reason = StopReason::none;
    std::string a, b;    // verdict about a pair: the bodies
    std::string detail;  // input, output: the fault that stopped; may be empty
    std::string file;    // the machine file
    std::int32_t program_line =
        0;                        // of the control, at the stop; 0: the control does not report it
    std::optional<WhyFacts> why;  // of the pair, if the stop is about its distance
    std::optional<std::uint16_t> unknown_tool;  // now in the spindle, and not in `file`
    std::string ways_out;  // of format_escapes, for axes at rest; empty: none was found
};

/// The cause first, then the pair's distances, then what leads out. Never empty.
[[nodiscard]] std::vector<std::string> stop_sentences(const StopAccount& account);

}  // namespace axg
