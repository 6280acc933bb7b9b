// SPDX-License-Identifier: Apache-2.0
// What a stop leaves: the latch, the output line, and the cause that a person reads.
#pragma once

#include <atomic>
#include <cstdint>

#include "core/guard/monitor.hpp"
#include "firmware_if/guard/pulse_line.hpp"

namespace axg {

/// The latch as two words in memory that outlives the process, so that storing it needs no call.
/// Only the exact pattern of "clear" is clear. The guard stores it when a person arms, before the
/// first permit. A stop of an armed guard therefore writes nothing: no page fault delays its frame,
/// and the death of the process cannot lose it.
struct LatchCell {
    std::uint64_t word = 0, inverse = 0;
};
inline constexpr std::uint64_t kLatchClear = 0x6178677561726421U;
[[nodiscard]] inline bool is_latched(const LatchCell& cell) noexcept {
    return cell.word != kLatchClear || cell.inverse != ~kLatchClear;
}
inline void set_latch(LatchCell& cell, bool is_latched) noexcept {
    const std::uint64_t word = is_latched ? ~kLatchClear : kLatchClear;
    // The memory belongs to a file: another process reads it, which the compiler cannot see.
    std::atomic_ref<std::uint64_t>(cell.word).store(word, std::memory_order_seq_cst);
    std::atomic_ref<std::uint64_t>(cell.inverse).store(~word, std::memory_order_seq_cst);
}

/// Reason and pair of the newest stop, and the query whose verdict it is.
struct StopCause {
    StopReason reason = StopReason::none;
    std::uint32_t pair = kNoIndex;  // kNoIndex: none
    std::uint32_t query = 0;        // LiveQuery::number; 0: none
};

/// The output line, in addition to the bus. Each permit makes one edge, which holds the monoflop
/// up: a thread that merely runs makes none.
struct EdgeLine {
    PulseLine* line = nullptr;  // null: there is none
    bool level = false;

    /// False: it could not be set, which counts as a frame that was not sent.
    [[nodiscard]] bool set(bool wanted) noexcept {
        if (line == nullptr || level == wanted) {
            return true;
        }
        level = wanted;
        return line->set(wanted);
    }
};

/// All that a stop sets beside its frames.
struct StopOutput {
    LatchCell& latch;
    EdgeLine line;
    StopCause cause;
};

}  // namespace axg
