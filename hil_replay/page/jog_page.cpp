// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/page/jog_page.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/sincos.hpp"

namespace axg {
namespace {

constexpr double kLinearMm = 50, kRotaryRad = 15 * kPi / 180;  // enough to be seen
constexpr double kShareOfTravel = 0.25;                        // of a short axis
constexpr double kJogSeconds = 2;                              // there and back
constexpr std::int64_t kPeriodUs = 20'000;

double start_of(const Axis& axis) {
    return axis.unlimited ? 0 : std::clamp(0.0, axis.min, axis.max);
}

}  // namespace

std::vector<AxisJog> plan_jogs(const Machine& machine) {
    std::vector<AxisJog> jogs;
    for (std::uint32_t i = 0; i < machine.axes.size(); ++i) {
        const Axis& axis = machine.axes[i];
        double distance = axis.kind == AxisKind::rotary ? kRotaryRad : kLinearMm;
        if (!axis.unlimited) {
            distance = std::min(distance, kShareOfTravel * (axis.max - axis.min));
        }
        const bool has_room = axis.unlimited || start_of(axis) + distance <= axis.max;
        jogs.push_back(
            {i, has_room ? distance : -distance, kJogSeconds * i, kJogSeconds * (i + 1)});
    }
    return jogs;
}

void record_jogs(const Machine& machine, const std::vector<AxisJog>& jogs, PageRecorder& page) {
    AxisSnapshot snapshot;
    snapshot.axis_count = static_cast<std::uint32_t>(machine.axes.size());
    snapshot.mode = kModeMoving;
    const double end_s = jogs.empty() ? 0 : jogs.back().end_s;
    while (static_cast<double>(snapshot.latched_us) * 1e-6 <= end_s + 1e-9) {
        const double time_s = static_cast<double>(snapshot.latched_us) * 1e-6;
        for (std::size_t i = 0; i < machine.axes.size(); ++i) {
            snapshot.position.at(i) = start_of(machine.axes[i]);
        }
        for (const AxisJog& jog : jogs) {
            const double share = (time_s - jog.begin_s) / (jog.end_s - jog.begin_s);
            if (share > 0 && share < 1) {
                snapshot.position.at(jog.axis) += jog.distance * (1 - std::fabs(2 * share - 1));
            }
        }
        page.note(snapshot, {.has_permit = true});
        snapshot.latched_us += kPeriodUs;
        snapshot.arrived_us = snapshot.latched_us;
        ++snapshot.sample;
    }
}

}  // namespace axg
