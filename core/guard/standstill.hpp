// SPDX-License-Identifier: Apache-2.0
// Whether every axis is at rest: from all samples of a time window, never from one frame or the
// mode only. Pure, fixed size, constant cost per sample; mm and s, or rad and s. Source:
// docs/reference/states.md, "Standstill".
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "core/base/limits.hpp"
#include "core/machine/axis_snapshot.hpp"
#include "core/machine/machine.hpp"

namespace axg {

inline constexpr std::uint64_t kNeverStands = UINT64_MAX;

/// Limits of a standstill of one machine. Zeroed memory is never at rest.
struct StandstillRules {
    std::uint32_t axis_count = 0;
    std::uint64_t window_samples = kNeverStands;  // from the oldest sample to the newest
    std::uint64_t gap_samples_max = 0;            // between two samples that follow each other
    std::int64_t age_us_max = 0;                  // of the newest sample, at a check
    std::int64_t latched_age_us = 0;              // of positions at their latch, at most
    bool is_reported = false;                     // the frames report motion, not only positions
    std::array<bool, kAxesMax> unlimited{};       // compared the short way round
    std::array<double, kAxesMax> width{};         // measured positions differ by at most this
    std::array<double, kAxesMax> true_width{};    // and then the axis itself by at most this
};

/// The window lasts at least 100 ms, 16 strides, and the time in which an axis at 0.1 mm/s (0.1
/// degrees/s) covers twice the width; at least 1 s for signals that do not report motion. Drives
/// that do not all report their speed are never at rest.
/// @param count  [axes] mm or rad of one count on the wire
[[nodiscard]] StandstillRules standstill_rules(const Machine& machine,
                                               std::span<const double> count) noexcept;

/// The window is stored as extremes of 16 parts, and of one that has begun.
inline constexpr std::uint64_t kStandstillParts = 16;

struct Standstill {
    struct Part {
        std::uint64_t number = UINT64_MAX;  // since sample 0; none
        std::array<double, kAxesMax> low{}, high{};
    };
    std::int64_t after_us = INT64_MIN;  // samples latched up to this instant do not count
    bool has_sample = false;
    std::uint64_t since = 0, newest = 0;  // samples without a hole, mode and reports quiet
    std::int64_t newest_us = 0;
    std::array<double, kAxesMax> last{};   // reported position
    std::array<double, kAxesMax> turns{};  // of an endless axis, to be added
    std::array<Part, kStandstillParts + 1> parts{};
};

/// Discards all samples. Call it at each stop, and whenever the receiver begins anew.
/// @param after_us  latch instant that a sample has to be newer than, such as that of the stop
void begin_standstill(Standstill& state, std::int64_t after_us) noexcept;

/// Records one coherent snapshot.
/// @param is_reported_still  the board reports no motion, apart from the mode: all points of the
///        look-ahead path are equal. (Reported speeds are part of the mode.)
void note_standstill(Standstill& state, const StandstillRules& rules, const AxisSnapshot& snapshot,
                     bool is_reported_still) noexcept;

/// Returns an axis that covered more than its width in the window, or in its recorded part;
/// kNoIndex: none, or no samples.
[[nodiscard]] std::uint32_t moving_axis(const Standstill& state,
                                        const StandstillRules& rules) noexcept;

/// True: every axis stayed within its width over the whole window, and the newest sample is fresh.
/// It does not detect frozen encoders.
[[nodiscard]] bool stands(const Standstill& state, const StandstillRules& rules,
                          std::int64_t now_us) noexcept;

}  // namespace axg
