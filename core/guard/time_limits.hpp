// SPDX-License-Identifier: Apache-2.0
// Every time limit of the guard of a machine, in one place: the deadline, its shares, and the
// limits that follow from the permit validity.
#pragma once

#include <algorithm>
#include <cstdint>

#include "core/machine/machine.hpp"

namespace axg {

/// Share of a cycle's deadline for the longest batch; the rest is for the snapshot, the
/// queries and the frames (tens of microseconds: docs/measurements/replay-speed.md).
inline constexpr double kEngineShare = 0.9;

// After bus-off, the kernel still accepts writes for up to a second. Two periods without an echo
// are enough to detect it, and never less than the kernel's own delays at 1 kHz.
inline constexpr std::int64_t kEchoUsMin = 2000;

struct TimeLimits {
    std::int64_t period_us = 0;    // between samples
    std::int64_t deadline_us = 0;  // from the last frame of a sample to its result
    double engine_us = 0;          // the engine's share of it
    // The longest permit, and so the longest permitted silence of guard or engine.
    std::int64_t permit_us = 0;
    std::int64_t least_permit_us = 0;  // every permit is valid for at least this
    std::int64_t echo_us = 0;          // limit to send an own frame, and then to receive its echo
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
