// SPDX-License-Identifier: Apache-2.0
// SYNC of a guard that is its producer (can.sync: guard): on a fixed grid of the guard's clock,
// with a counter that numbers the periods of the grid, whether their SYNC was sent or not. Pure.
// Source: docs/reference/axguardd.md, "SYNC from the guard".
#pragma once

#include <cmath>
#include <cstdint>

#include "core/machine/machine.hpp"
#include "firmware_if/protocol/axis_frames.hpp"

namespace axg {

struct SyncProducer {
    std::int64_t period_us = 0;  // 0: another node is the producer
    std::int64_t jitter_us = 0;  // SYNC ends at most so long after its instant of the grid
    std::int64_t due_us = 0;     // the next instant of the grid
    std::uint64_t number = 0;    // its number
};

[[nodiscard]] inline SyncProducer make_sync_producer(const Machine& machine,
                                                     std::int64_t now_us) noexcept {
    if (!machine.can.guard_sends_sync) {
        return {};
    }
    return {.period_us = machine.can.sample_us,
            .jitter_us = std::lround(machine.guard.latch_jitter_s * 1e6),
            .due_us = now_us};
}

/// INT64_MAX: never.
[[nodiscard]] constexpr std::int64_t next_sync_us(const SyncProducer& sync) noexcept {
    return sync.period_us == 0 ? INT64_MAX : sync.due_us;
}

/// The counter of a SYNC to be sent now; 0: none. Half of the jitter is for late calls, the rest is
/// for the bus. A SYNC that would be later is skipped together with its number.
[[nodiscard]] constexpr std::uint8_t take_sync(SyncProducer& sync, std::int64_t now_us) noexcept {
    if (sync.period_us == 0 || now_us < sync.due_us) {
        return 0;
    }
    const std::int64_t slept = (now_us - sync.due_us) / sync.period_us;
    const std::uint64_t number = sync.number + static_cast<std::uint64_t>(slept);
    const std::int64_t late_us = now_us - sync.due_us - slept * sync.period_us;
    sync.due_us += (slept + 1) * sync.period_us;
    sync.number = number + 1;
    return 2 * late_us <= sync.jitter_us ? sync_counter_of(number) : std::uint8_t{0};
}

/// Whether a SYNC with this counter, seen on the bus, ended soon enough after its instant.
[[nodiscard]] constexpr bool is_sync_in_time(const SyncProducer& sync, std::uint8_t counter,
                                             std::int64_t ended_us) noexcept {
    if (sync.period_us == 0) {
        return true;
    }
    const std::uint64_t next = sync.number % kSyncCounterMax;  // less one, as the counter below
    const std::uint64_t ago =
        (next + 2 * kSyncCounterMax - counter) % kSyncCounterMax + 1;  // periods before the next
    const std::int64_t late_us =
        ended_us - (sync.due_us - static_cast<std::int64_t>(ago) * sync.period_us);
    return late_us >= 0 && late_us <= sync.jitter_us;
}

}  // namespace axg
