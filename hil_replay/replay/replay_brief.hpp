// SPDX-License-Identifier: Apache-2.0
// A replay on one screen: what was proven, how long a cycle took, and what no reader may miss. Rows
// that say nothing about the run are in the full report only.
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

/// The figures of the run: a line each, and one for each thing that is not as declared.
void print_summary(const ReplayReport& report, std::FILE* words);

/// A line of a pair near a stop: contact, nesting or clearance.
void print_pair(const Machine& machine, const PairAtStop& pair, Detail detail, std::FILE* words);
/// Of a stop: pairs in contact, or the nearest where no sentence states a distance.
/// @param has_why  its sentences are printed
/// @return  whether the pair of the stop touches
bool print_brief_pairs(const ReplayReport& report, const StopEvent& stop, bool has_why,
                       std::FILE* words);

}  // namespace axg
