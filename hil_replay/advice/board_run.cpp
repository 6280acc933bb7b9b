// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/advice/board_run.hpp"

#include "config/machine/effective_text.hpp"
#include "firmware_if/setup/cycle_parts.hpp"
#include "hil_replay/drive/drive_run.hpp"
#include "hil_replay/motion/program_motion.hpp"

namespace axg {

std::optional<RunEnd> run_board(const LoadedMachine& loaded, const BoardRun& run) {
    const Machine& machine = loaded.machine;
    CycleParts parts(loaded, true);
    if (!parts.has_memory()) {
        return std::nullopt;
    }
    GuardChain chain(machine, run.engine, run.containment_test, parts.chain());
    DriveOptions options;
    options.board = promised_board(machine, run.seed);
    options.board.tick_us = kMotionStepUs;
    options.board.hashes = configuration_hashes(machine, loaded.meshes);
    options.response_us = machine.deadline_us;
    options.time_us_max = run.time_us_max;
    const MotionLimits limits = make_motion_limits(machine);
    double share = 1.0 / kSpeedCapRapid;
    AxisShares shares;
    const bool keeps_cap = machine.guard.cap != CapPromise::none;
    const bool is_slowed = keeps_cap || parts.margin_advisory() != nullptr;
    options.speed_share = is_slowed && !keeps_cap ? &share : nullptr;
    options.obeys_cap = false;
    keep_caps(machine, limits.smooth_s, &share, &shares, options.board);
    const MotionOptions motion;
    const DriveResult result = drive(
        machine, chain, {run.start.data(), machine.axes.size()},
        make_program_motion(run.program, limits, motion,
                            is_slowed && options.board.axis_shares == nullptr ? &share : nullptr,
                            nullptr, options.board.axis_shares),
        options);
    const DriveStop& stop = result.guard_stop;
    RunEnd end{.is_stopped = has_reason(stop) || result.is_held,
               .is_complete =
                   result.encoded.status == EncodeStatus::ok && result.state != BoardState::waiting,
               .pair = has_reason(stop) ? stop.pair : run.pair,
               .snapshot = has_reason(stop) ? stop.snapshot : snapshot_at_rest(machine, result),
               .ended_us = result.ended_us};
    if (end.is_stopped && end.pair != kNoIndex) {
        end.left_mm = distance_left(machine, run.engine, end.snapshot, end.pair, stop.unproven);
    }
    return end;
}

}  // namespace axg
