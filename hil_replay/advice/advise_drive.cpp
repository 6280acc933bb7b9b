// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/advice/advise_drive.hpp"

#include <algorithm>
#include <cmath>

#include "hil_replay/advice/gain.hpp"
#include "hil_replay/board/motion_board.hpp"

namespace axg {

bool is_advisable(StopReason reason, const UnprovenPair& unproven) noexcept {
    return reason == StopReason::predicted && unproven.is_known && !unproven.is_blind &&
           !unproven.is_jog;
}

void advise_drive(const DriveAdvice& advice, Advice& out) {
    out.was_driven = true;
    const auto is_known = [&out](const Setting& setting) {  // by the trace
        return std::any_of(
            out.settings.begin(), out.settings.end(),
            [&setting](const AdvisedSetting& one) { return one.lines == setting.lines; });
    };
    for (const Setting& setting : settings_of_board(advice.loaded.machine, advice.unproven)) {
        const auto changed =
            is_known(setting) ? std::nullopt : with_setting(advice.loaded, setting.lines);
        if (!changed) {
            continue;
        }
        const CanLayout& can = changed->machine.can;
        BoardRun run = advice.run;
        run.pair = advice.first.pair;
        run.time_us_max = advice.first.snapshot.latched_us - kBoardStartUs +
                          std::llround(kAdviceAfterS * 1e6) +
                          std::int64_t{can.look_ahead_samples} * can.sample_us;
        const std::optional<RunEnd> again = run_board(*changed, run);
        if (again) {
            note_end(setting, true, advice.first, *again, out);
        }
    }
    sort_settings(out);
}

}  // namespace axg
