// SPDX-License-Identifier: Apache-2.0
// The lines that a guard node may log now: a cause that lasts, a faulty panel or board cannot fill
// the log. us.
#pragma once

#include <array>
#include <cstdint>

#include "core/guard/monitor.hpp"
#include "core/machine/configuration_hashes.hpp"
#include "firmware_if/guard/live_messages.hpp"
#include "firmware_if/guard/operator_desk.hpp"
#include "firmware_if/guard/spsc_queue.hpp"

namespace axg {

using NoteQueue = SpscQueue<LiveNote, 256>;

/// Times of the next line of each kind, at most one a second; and the queue to the logger.
struct NodeLog {
    static constexpr std::int64_t kEachUs = 1'000'000;

    /// `notes_to` must outlive it.
    explicit NodeLog(NoteQueue& notes_to) noexcept : notes(notes_to) {}

    NoteQueue& notes;
    std::uint64_t lost = 0;  // lines that found the queue full, and were not reported yet
    // The logged cause of not being ready.
    StopReason reason = StopReason::none;
    std::uint32_t pair = kNoIndex;
    std::uint32_t contradicted_axis = kNoIndex;  // at the last check
    bool is_held = false;                        // the last result was held by the cap
    std::int64_t withheld_us = 0, session_us = 0, period_us = 0;
    std::array<std::int64_t, kOperatorNotes> operator_us{};
    std::array<std::int64_t, kHashParts> hash_us{};

    /// The guard begins anew. The first samples after a start have no speeds, so near pairs are not
    /// proven for some of them: a pair whose proof comes and goes must not log a line every period.
    void begin(std::int64_t now_us) noexcept {
        forget_withheld();
        is_held = false;
        withheld_us = session_us = period_us = now_us + kEachUs;
    }
    void forget_withheld() noexcept {
        reason = StopReason::none;
        pair = kNoIndex;
    }
    /// Whether a line of the kind is due; then the next one is a second later.
    [[nodiscard]] static bool take(std::int64_t& next_us, std::int64_t now_us) noexcept {
        if (now_us < next_us) {
            return false;
        }
        next_us = now_us + kEachUs;
        return true;
    }
    /// Returns `lost`. A line about lost ones goes before.
    std::uint64_t push(const LiveNote& entry) noexcept {
        if (lost != 0) {
            const LiveNote gap{.kind = LiveNote::Kind::lost,
                               .time_us = entry.time_us,
                               .count = static_cast<std::uint32_t>(lost)};
            lost = notes.push(gap) ? 0 : lost;
        }
        lost += notes.push(entry) ? 0U : 1U;
        return lost;
    }
};

}  // namespace axg
