// SPDX-License-Identifier: Apache-2.0
// Prints a replay on one screen: the proven samples, the time of a cycle, and everything that no
// reader may miss. Rows without information on the run are in the full report only.
#pragma once

#include <cstdint>
#include <cstdio>
#include <string>

#include "hil_replay/replay/pairs_at_stop.hpp"
#include "hil_replay/replay/replay_report.hpp"

namespace axg {

[[nodiscard]] constexpr double us_of(std::int64_t ns) noexcept {
    return static_cast<double>(ns) * 1e-3;
}

/// "43839 of 43840 samples proven, 1 too early to know a speed"
[[nodiscard]] std::string proven_text(const ReplayReport& report);
/// "us per cycle on this computer: median 9.7, p99 18.9, longest 134.5"
[[nodiscard]] std::string cycle_text(const ReplayReport& report);
/// "deadline 500 us: 0 of 43840 cycles late", and whether late ones are judged.
[[nodiscard]] std::string deadline_text(const ReplayReport& report);

/// Prints a line for each figure of the run, and one for each deviation from a declared value.
void print_summary(const ReplayReport& report, std::FILE* words);

/// Prints a line on a pair near a stop: contact, nesting or clearance.
void print_pair(const Machine& machine, const PairAtStop& pair, Detail detail, std::FILE* words);
/// Prints a stop's pairs in contact, or the nearest one if no sentence states a distance.
/// @param has_why  its sentences are printed
/// @return  whether the pair of the stop touches
bool print_brief_pairs(const ReplayReport& report, const StopEvent& stop, bool has_why,
                       std::FILE* words);

}  // namespace axg
