// SPDX-License-Identifier: Apache-2.0
// Every time that the guard of a machine is held to, in one place: the deadline, its shares, and
// what follows from how long a permit lasts.
#pragma once

#include <algorithm>
#include <cstdint>

#include "core/machine/machine.hpp"

namespace axg {

/// How much of a cycle's deadline the longest batch may take; the rest is for the snapshot, the
/// queries and the frames (tens of microseconds: docs/measurements/replay-speed.md).
inline constexpr double kEngineShare = 0.9;

// The kernel facts of bus-off: a write still succeeds for up to a second. Two periods without an
// echo are enough to know, and never less than the kernel's own delays at 1 kHz.
inline constexpr std::int64_t kEchoUsMin = 2000;

struct TimeLimits {
    std::int64_t period_us = 0;    // between samples
    std::int64_t deadline_us = 0;  // from the last frame of a sample to its result
    double engine_us = 0;          // the engine's share of it
    // The longest permit: so long guard or engine may say nothing at all.
    std::int64_t permit_us = 0;
    std::int64_t least_permit_us = 0;  // that every permit is valid for
    std::int64_t echo_us = 0;          // an own frame must be taken, and then seen, within it
};

[[nodiscard]] inline TimeLimits time_limits(const CanLayout& can,
                                            std::int64_t deadline_us) noexcept {
    const std::int64_t period_us = can.sample_us;
    return {.period_us = period_us,
            .deadline_us = deadline_us,
            .engine_us = kEngineShare * static_cast<double>(deadline_us),
            .permit_us = can.permit_samples.most * period_us,
            .least_permit_us = can.permit_samples.least * period_us,
            .echo_us = std::max(kEchoUsMin, 2 * period_us)};
}
[[nodiscard]] inline TimeLimits time_limits(const Machine& machine) noexcept {
    return time_limits(machine.can, machine.deadline_us);
}

}  // namespace axg
