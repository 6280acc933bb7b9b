// SPDX-License-Identifier: Apache-2.0
// Settings with which a driven program stops nearer: each is driven once more.
#pragma once

#include "hil_replay/advice/board_run.hpp"
#include "hil_replay/advice/settings.hpp"

namespace axg {

inline constexpr double kAdviceAfterS = 10;  // of motion beyond the stop

struct DriveAdvice {
    const LoadedMachine& loaded;   // as the first run had it
    BoardRun run;                  // of that run; its time is set here
    const RunEnd& first;           // a stop for a pair
    const UnprovenPair& unproven;  // the same
};
/// Adds to `out`. Cost: up to 7 drives of the program to its stop and kAdviceAfterS more.
void advise_drive(const DriveAdvice& advice, Advice& out);

/// Whether a stop is one of distance, which a setting may make nearer.
[[nodiscard]] bool is_advisable(StopReason reason, const UnprovenPair& unproven) noexcept;

}  // namespace axg
