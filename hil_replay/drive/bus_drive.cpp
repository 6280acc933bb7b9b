// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/drive/bus_drive.hpp"

#include <utility>

#include "firmware_if/guard/standstill_watch.hpp"

namespace axg {

namespace {

constexpr std::uint64_t kRestSamplesMore = 20;  // some are lost, and some precede the stop

/// Number of samples at rest that the guard needs to detect standstill.
std::uint64_t rest_samples(const Machine& machine) {
    const std::uint64_t window = standstill_rules(machine).window_samples;
    return (window == kNeverStands ? 0 : window) + kRestSamplesMore;
}

/// Runs samples until the axes rest, or until a waiting board can no longer start.
void play(LiveLoop& loop, MotionBoard& board, DriveTally& tally, const std::atomic<bool>& is_ended,
          const BusDriveObservers& observers) {
    while (!board.is_at_rest()) {
        const bool is_over = is_ended.load();
        const bool is_waiting = board.state() == BoardState::waiting;
        if (is_waiting && (is_over || loop.report().is_lost)) {
            return;
        }
        if (is_over) {
            board.stop_by_person(loop.board_now_us());
        }
        if (!loop.cycle()) {
            return;
        }
        tally.note(board);
        if (observers.each) {
            observers.each(board);
        }
    }
}

}  // namespace

BoardOptions promised_live_board(const Machine& machine, std::uint64_t seed) {
    BoardOptions board = promised_board(machine, seed);
    board.latch_jitter_us_max = 0;
    return board;
}

BusDriveResult drive_on_bus(const Machine& machine, CanTransport& wire, const LiveClock& clock,
                            std::span<const double> start, CommandedMotion motion,
                            const BusDriveOptions& options, const std::atomic<bool>& is_ended,
                            const BusDriveObservers& observers) {
    MotionBoard board(machine, start, std::move(motion), options.board);
    if (observers.watch) {
        board.watch([&](std::int64_t time_us,
                        std::span<const AxisMotion>) { observers.watch(time_us, board); },
                    observers.watch_us);
    }
    LiveLoop loop(machine, board, wire, clock);
    DriveTally tally(options.speed_share, options.obeys_cap, options.lost_s);
    if (loop.listen()) {
        play(loop, board, tally, is_ended, observers);
    }
    BusDriveResult result{.drive = tally.result(machine, board), .wire = loop.report()};
    const std::uint64_t samples = rest_samples(machine);
    for (std::uint64_t i = 0; i < samples && board.is_at_rest() && loop.cycle(); ++i) {
    }
    result.wire = loop.report();
    result.drive.frames_lost = result.wire.frames_refused;
    result.drive.guard_stop.snapshot.tool = board.tool();
    return result;
}

}  // namespace axg
