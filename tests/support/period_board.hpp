// SPDX-License-Identifier: Apache-2.0
// A board whose period and whose stamps a test chooses, and what a receiver that waits for the
// period made of it.
#pragma once

#include <functional>
#include <optional>

#include "tests/support/can_board.hpp"

namespace axg::test {

struct PeriodBoard {
    CanFormat format = CanFormat::classical;
    double period_us = 1000;  // the true one
    std::uint64_t samples = 400;
    // How late sample k is delivered, all its frames; empty: by nothing.
    std::function<std::int64_t(std::uint64_t)> late_us{};
    std::function<bool(std::uint64_t)> is_lost{};  // empty: none is
};

/// Sample numbers, counted as the board does.
struct PeriodHeard {
    std::optional<std::uint64_t> valid_at;  // the first sample handed out in VALID
    std::optional<std::uint64_t> wrong_at;  // sync_period
    ReceiverFault stop = ReceiverFault::none;
    std::int64_t measured_ns = 0;
};

/// At rest, so that nothing but the period can be wrong.
inline PeriodHeard hear_period(const PeriodBoard& board, const Machine& machine,
                               PeriodUse use = PeriodUse::proven) {
    AxisReceiver receiver(machine, {.period = use});
    AxisEncoder encoder(machine);
    PeriodHeard heard;
    for (std::uint64_t k = 0; k < board.samples && heard.stop == ReceiverFault::none; ++k) {
        AxisSnapshot snapshot = snapshot_at(machine, 0);
        snapshot.mode = kModeStandstill;
        snapshot.sample = k;
        snapshot.latched_us = 1'000'000 + std::llround(static_cast<double>(k) * board.period_us);
        const std::int64_t late_us = board.late_us ? board.late_us(k) : 0;
        for (CanFrame& frame : frames_of(encoder, snapshot)) {
            frame.time_us += late_us;
            if (board.is_lost && board.is_lost(k)) {
                continue;
            }
            const ReceiverEvent event = receiver.on_frame(frame);
            if (event.kind == ReceiverEvent::Kind::snapshot &&
                event.state == ReceiverState::valid && !heard.valid_at) {
                heard.valid_at = k;
            }
            if (event.kind == ReceiverEvent::Kind::fault &&
                event.fault == ReceiverFault::sync_period) {
                heard.wrong_at = k;
            }
        }
        heard.stop = receiver.stop_cause();
    }
    heard.measured_ns = receiver.counters().measured_period_ns;
    return heard;
}
inline PeriodHeard hear_period(const PeriodBoard& board) {
    return hear_period(board, five_axis_machine(board.format));
}

}  // namespace axg::test
