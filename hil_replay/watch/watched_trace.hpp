// SPDX-License-Identifier: Apache-2.0
// What of board and guard a recorded bus has, read before it is played, and the words about what is
// missing: a candump of the board only shows no guard, and the page would be silent about why.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/machine/machine.hpp"

namespace axg {

struct TraceContent {
    std::string name;          // of the file
    std::uint64_t frames = 0;  // all that could be read
    std::uint64_t of_board = 0, of_guard = 0;
    std::int64_t first_us = 0, last_us = 0;  // of its clock
    std::uint64_t skipped = 0;               // lines that could not be read
    std::string first_skipped;               // FILE:LINE: what was wrong with it
    std::string fault;  // where the reading ended before the end of the file; empty: nowhere
};

/// Reads the trace to its end. nullopt: `fault` has the failure and the next step.
[[nodiscard]] std::optional<TraceContent> read_content(const Machine& machine,
                                                       const std::string& path, std::string& fault);

/// Why these traces show nothing together: no frame of the machine, or no common time. Empty: they
/// show something.
[[nodiscard]] std::string fault_of_traces(const std::vector<TraceContent>& traces);

/// What is missing for a whole page, and what to do; a sentence or two each.
/// @param machine_file  as the user named it
[[nodiscard]] std::vector<std::string> notes_about(const std::vector<TraceContent>& traces,
                                                   const Machine& machine,
                                                   const std::string& machine_file);

}  // namespace axg
