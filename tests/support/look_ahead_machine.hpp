// SPDX-License-Identifier: Apache-2.0
// A board that announces its path, for tests that draw machines.
#pragma once

#include <algorithm>
#include <cstdint>
#include <random>

#include "core/certificate/stop_certificate.hpp"
#include "core/machine/machine.hpp"
#include "core/reach/look_ahead_path.hpp"
#include "firmware_if/protocol/axis_frames.hpp"
#include "tests/support/between.hpp"

namespace axg::test {

/// The largest following errors that are drawn, mm and rad.
struct FollowingErrors {
    double linear_mm = 0, rotary_rad = 0;
};

/// The look-ahead path is as long as a stop along it may take; half the axes have an error.
inline void give_look_ahead(std::mt19937_64& random, const FollowingErrors& most,
                            Machine& machine) {
    double p = 0, z = 0;
    for (Axis& axis : machine.axes) {
        p = std::max(p, axis.speed_max / axis.stopping_min);
        z = std::max(z, axis.speed_max / axis.jerk_max);
        const double error = axis.kind == AxisKind::rotary ? most.rotary_rad : most.linear_mm;
        axis.following_error = random() % 2 == 0 ? between(random, 0, error) : 0;
    }
    const double stop_s =
        free_seconds(machine, machine.can.permit_samples.most) + path_braking_s(p, z);
    const double period_s = machine.can.sample_us * 1e-6;
    machine.can.format = CanFormat::fd;
    machine.can.look_ahead_samples =
        std::min(kLookAheadSamplesMax, static_cast<std::uint32_t>(1.02 * stop_s / period_s) + 4);
}

}  // namespace axg::test
