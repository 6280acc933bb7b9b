// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/advice/advise_drive.hpp"

#include <algorithm>
#include <cmath>

#include "hil_replay/advice/gain.hpp"
#include "hil_replay/board/motion_board.hpp"

namespace axg {
namespace {

// A setting that leaves no more than this makes a stronger one of its kind needless.
constexpr double kEnoughMm = 0.1;

/// Whether an earlier setting of the kind leaves so little that `kind` needs no run.
bool is_needless(SettingKind kind, bool is_cap_enough, bool is_ahead_enough) noexcept {
    return (kind == SettingKind::cap_per_axis && is_cap_enough) ||
           (kind == SettingKind::path_keeping && is_ahead_enough);
}

}  // namespace

bool is_advisable(StopReason reason, const UnprovenPair& unproven) noexcept {
    return reason == StopReason::predicted && unproven.is_known && !unproven.is_blind &&
           !unproven.is_jog;
}

void advise_drive(const DriveAdvice& advice, Advice& out) {
    out.was_driven = true;
    bool is_cap_enough = false, is_ahead_enough = false;
    const auto is_known = [&out](const Setting& setting) {  // by the trace
        return std::any_of(
            out.settings.begin(), out.settings.end(),
            [&setting](const AdvisedSetting& one) { return one.lines == setting.lines; });
    };
    for (const Setting& setting : settings_of_board(advice.loaded.machine, advice.unproven)) {
        const auto changed =
            is_needless(setting.kind, is_cap_enough, is_ahead_enough) || is_known(setting)
                ? std::nullopt
                : with_setting(advice.loaded, setting.lines);
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
        if (!again) {
            continue;
        }
        note_end(setting, true, advice.first, *again, out);
        const bool is_enough =
            !again->is_stopped || (again->pair == advice.first.pair && again->left_mm <= kEnoughMm);
        is_cap_enough = is_cap_enough || (is_enough && setting.kind == SettingKind::cap);
        is_ahead_enough = is_ahead_enough || (is_enough && setting.kind == SettingKind::ahead);
    }
    sort_settings(out);
}

}  // namespace axg
