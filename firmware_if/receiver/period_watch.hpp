// SPDX-License-Identifier: Apache-2.0
// Whether the board's period is the declared one, from stamps that may be late. Pure; a stamp costs
// a check of 13 windows. Source: docs/reference/protocol.md, "Receiver rules", rule 6.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

namespace axg {

enum class PeriodVerdict : std::uint8_t { unknown = 0, right, wrong };

// Every proof supposes the declared period to one part in this
// (core/reach/motion_history.hpp).
inline constexpr std::int64_t kPeriodPart = 100;
// Two clocks run apart by 200 ppm at most.
inline constexpr std::int64_t kClockPart = 5000;

struct PeriodTerms {
    std::int64_t period_us = 1;  // declared
    // Largest lateness of a stamp against another one: for a proof of the period, and for its
    // refutation.
    std::int64_t right_us = 0, wrong_us = 0;
    // The least late of so many stamps in a row represents all of them: the others may be late by
    // any time.
    std::uint32_t unit = 1;
};

/// Whether `samples` periods that lasted `elapsed_us` show the period, with the largest errors of
/// the two stamps.
[[nodiscard]] constexpr PeriodVerdict judge_window(const PeriodTerms& terms, std::int64_t samples,
                                                   std::int64_t elapsed_us) noexcept {
    const std::int64_t wanted_us = samples * terms.period_us;
    const std::int64_t off_us = std::max(elapsed_us - wanted_us, wanted_us - elapsed_us);
    // All times are multiplied by kPeriodPart, so that one percent of the window is `wanted_us`.
    const std::int64_t off = kPeriodPart * off_us;
    const std::int64_t clock = kPeriodPart * wanted_us / kClockPart + 1;
    if (off > wanted_us + kPeriodPart * terms.wrong_us + clock) {
        return PeriodVerdict::wrong;
    }
    return off + kPeriodPart * terms.right_us + clock <= wanted_us ? PeriodVerdict::right
                                                                   : PeriodVerdict::unknown;
}

/// Windows of 1, 2, 4 ... 4096 samples and more, each begun anew where it ended.
struct PeriodWatch {
    static constexpr std::uint32_t kWindows = 13;

    struct Mark {
        std::int64_t sample = 0, stamp_us = 0;
    };

    PeriodTerms terms;
    std::int64_t sample = 0;   // of the newest stamp, counted from the first
    std::uint32_t stamps = 0;  // of this unit
    bool has_marks = false;    // a unit is complete
    Mark least{};              // of this unit
    std::array<Mark, kWindows> begins{};
    std::int64_t measured_ns = 0;  // the mean period of the last window that showed something
};

/// Discards all stamps: the next one belongs to another board, or to an unknown sample.
constexpr void restart(PeriodWatch& watch) noexcept {
    watch = PeriodWatch{.terms = watch.terms, .measured_ns = watch.measured_ns};
}

/// Judges the windows that end with the unit that is complete. A wrong one goes before a right one,
/// a long one before a short one.
[[nodiscard]] constexpr PeriodVerdict judge_windows(PeriodWatch& watch) noexcept {
    PeriodVerdict verdict = PeriodVerdict::unknown;
    for (std::uint32_t i = 0; i < PeriodWatch::kWindows; ++i) {
        PeriodWatch::Mark& begin = watch.begins[i];
        const std::int64_t samples = watch.least.sample - begin.sample;
        if (watch.has_marks && samples < std::int64_t{1} << i) {
            break;  // a longer one ends where a shorter one does
        }
        const std::int64_t elapsed_us = watch.least.stamp_us - begin.stamp_us;
        begin = watch.least;
        const PeriodVerdict judged = watch.has_marks
                                         ? judge_window(watch.terms, samples, elapsed_us)
                                         : PeriodVerdict::unknown;
        if (judged != PeriodVerdict::unknown && verdict != PeriodVerdict::wrong) {
            verdict = judged;
            watch.measured_ns = 1000 * elapsed_us / samples;
        } else if (judged == PeriodVerdict::wrong) {
            watch.measured_ns = 1000 * elapsed_us / samples;
        }
    }
    watch.has_marks = true;
    return verdict;
}

/// One stamp, `steps` samples after the last one. The steps of the first one count nothing.
[[nodiscard]] constexpr PeriodVerdict judge_stamp(PeriodWatch& watch, std::int64_t steps,
                                                  std::int64_t stamp_us) noexcept {
    watch.sample += steps;
    const std::int64_t later_us = stamp_us - watch.least.stamp_us;
    if (watch.stamps == 0 ||
        later_us < (watch.sample - watch.least.sample) * watch.terms.period_us) {
        watch.least = {watch.sample, stamp_us};
    }
    if (++watch.stamps < watch.terms.unit) {
        return PeriodVerdict::unknown;
    }
    watch.stamps = 0;
    return judge_windows(watch);
}

}  // namespace axg
