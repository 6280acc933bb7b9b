// SPDX-License-Identifier: Apache-2.0
// Common to all formats between frames and snapshots: the sample that is being assembled, the last
// one that was handed out, and whether stamps have shown the board's period. Pure. Claim: no
// instant is younger than its stamp (tests/unit/firmware_if/receiver/axis_assembly_test.cpp).
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include "core/machine/axis_snapshot.hpp"
#include "firmware_if/protocol/axis_frames.hpp"
#include "firmware_if/receiver/period_watch.hpp"

namespace axg {

static_assert(kAxisFramesMax < 64, "a bit for each frame of a snapshot");

/// The frames of one sample, as they come.
struct SampleSet {
    std::uint64_t whole = 0;  // bits of all frames
    std::uint64_t seen = 0;   // bit per axis frame; 0: none came
    std::uint8_t index = 0;   // that the frames state, where they do
    std::int64_t first_us = 0;
    AxisSnapshot snapshot;
    std::array<std::int64_t, kAxesMax> raw{};

    void add(const AxisFrameContent& content, std::uint32_t slot) noexcept {
        seen |= std::uint64_t{1} << slot;
        for (std::uint32_t i = 0; i < content.value_count; ++i) {
            const auto& value = content.values[i];
            snapshot.position[value.axis] = value.position;
            raw[value.axis] = value.raw;
        }
        if (content.has_status) {  // several frames may each state a mode
            snapshot.mode = std::max(snapshot.mode, content.mode);
            snapshot.flags |= content.flags;
        }
        if (content.has_tool) {
            snapshot.tool = content.tool;
        }
    }
    [[nodiscard]] bool has(std::uint32_t slot) const noexcept { return (seen >> slot & 1U) != 0; }
    [[nodiscard]] bool is_complete() const noexcept { return seen == whole; }
};

/// The instant of a sample.
struct Latch {
    std::int64_t time_us = 0;
    std::uint8_t sync_counter = 0;
    std::int64_t base_us = 0;  // LastSample::base_us if this sample is used
};

/// What the last snapshot leaves for the next sample.
struct LastSample {
    bool is_known = false;     // since references were cleared
    bool has_history = false;  // a snapshot was handed out, before an acknowledge perhaps
    std::uint8_t index = 0;
    std::uint8_t sync_counter = 0;
    std::int64_t latched_us = 0;
    std::int64_t base_us = 0;  // its SYNC, without what a queue added
    std::uint64_t sample = 0;
};

/// Whether stamps of one kind show the period.
struct PeriodProof {
    PeriodWatch watch;
    bool is_needed = true;  // false: the format has no such stamps
    bool is_shown = false;
};

struct ReceivedSamples {
    std::uint32_t axis_count = 0;
    std::int64_t period_us = 0;  // declared
    std::int64_t now_us = INT64_MIN;
    SampleSet set;
    LastSample last;
    std::uint32_t steps = 0;  // periods since the last snapshot, where the assembler counts them
    bool judges_period = true;
    PeriodProof by_sync;    // without SYNC: by arrival
    PeriodProof by_sender;  // by the sender's clock, which may be wrong by as much as the period
    std::int64_t measured_period_ns = 0;  // of the last window that showed something

    void begin(std::uint8_t index) noexcept {
        set.seen = 0;
        set.index = index;
        set.first_us = now_us;
        set.snapshot = AxisSnapshot{};
        set.snapshot.axis_count = axis_count;
    }
    /// Also stores that the period was shown to be right.
    [[nodiscard]] bool is_period_wrong(PeriodProof& proof, std::int64_t periods,
                                       std::int64_t stamp_us) noexcept {
        if (!judges_period) {
            return false;
        }
        const PeriodVerdict verdict = judge_stamp(proof.watch, periods, stamp_us);
        if (verdict != PeriodVerdict::unknown) {
            measured_period_ns = proof.watch.measured_ns;
        }
        proof.is_shown = proof.is_shown || verdict == PeriodVerdict::right;
        return verdict == PeriodVerdict::wrong;
    }
    /// A SYNC held up in a queue must not make its sample younger: it counts as late by the
    /// tolerance of its period and no more, and late ones in a row move the base slowly.
    [[nodiscard]] Latch dated(std::int64_t stamp_us, std::uint8_t sync_counter,
                              std::uint32_t periods) const noexcept {
        if (!last.is_known) {
            return {stamp_us, sync_counter, stamp_us};
        }
        const std::int64_t elapsed_us = periods * period_us;
        const std::int64_t expected_us = last.base_us + elapsed_us;
        return {std::min(stamp_us, expected_us + period_us / 5), sync_counter,
                std::min(stamp_us, expected_us + elapsed_us / kPeriodPart + 1)};
    }
    /// Clears all references. The number of the newest sample stays.
    void forget() noexcept {
        set.seen = 0;
        last.is_known = false;
        steps = 0;
        for (PeriodProof* const proof : {&by_sync, &by_sender}) {
            restart(proof->watch);
            proof->is_shown = !proof->is_needed;
        }
    }
};

}  // namespace axg
