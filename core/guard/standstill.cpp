// SPDX-License-Identifier: Apache-2.0
#include "core/guard/standstill.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/assert.hpp"
#include "core/base/finite.hpp"
#include "core/base/sincos.hpp"
#include "core/certificate/stop_certificate.hpp"

namespace axg {
namespace {

constexpr double kWindowS = 0.1, kWindowUntoldS = 1.0;
constexpr double kStrides = 16, kStrideS = 1e-3;
constexpr double kWidthCounts = 2;         // two roundings, and as much again
constexpr double kHolesPeriodS = 2e-3;     // with longer periods an axis could swing in a hole
constexpr std::uint64_t kHoleSamples = 3;  // lost in a row
constexpr double kSlowest = 0.1;           // mm/s or degrees/s: an axis as slow as that is found
constexpr double kRadADegree = kPi / 180;
constexpr double kRoundings = 1 + 0x1p-30;  // more than those of any position

std::uint64_t part_samples(const StandstillRules& rules) noexcept {
    return (rules.window_samples - 1) / kStandstillParts + 1;
}

/// Zero would be a standstill without any evidence.
bool can_stand(const StandstillRules& rules) noexcept {
    return rules.window_samples > 0 && rules.window_samples != kNeverStands;
}

bool is_quiet(const StandstillRules& rules, const AxisSnapshot& snapshot) noexcept {
    // Standstill also if no signal reports a mode. An axis is also at rest in a jog that was chosen
    // and has not begun, and a person may arm it: in this mode only the positions show the rest.
    bool quiet = snapshot.mode == kModeStandstill || snapshot.mode == kModeJog;
    for (std::uint32_t i = 0; i < rules.axis_count; ++i) {
        quiet = quiet && is_finite(snapshot.position[i]);
    }
    return quiet;
}

/// Returns the position without the jump of an endless axis at the seam of its turn.
double unwrapped(Standstill& s, const StandstillRules& rules, const AxisSnapshot& snapshot,
                 std::uint32_t axis) noexcept {
    const double position = snapshot.position[axis];
    if (rules.unlimited[axis] && s.has_sample) {
        s.turns[axis] -= std::round((position - s.last[axis]) / (2 * kPi));
    }
    s.last[axis] = position;
    return position + 2 * kPi * s.turns[axis];
}

}  // namespace

StandstillRules standstill_rules(const Machine& machine, std::span<const double> count) noexcept {
    AXG_ASSERT(count.size() >= machine.axes.size());
    StandstillRules out;
    const double period_s = machine.can.sample_us * 1e-6;
    const bool is_told = reports_motion(machine.can, machine.axes.size());
    bool is_seen = is_told || wire_of(machine.can).rest == RestReport::optional;
    out.axis_count = static_cast<std::uint32_t>(machine.axes.size());
    out.gap_samples_max = period_s > kHolesPeriodS ? 1 : 1 + kHoleSamples;
    out.age_us_max = machine.can.stale_after_us;
    out.latched_age_us = std::llround(std::ceil(age_seconds(machine).most * 1e6));
    out.is_reported = is_told;
    double window_s = std::max(
        {kWindowS, is_told ? 0.0 : kWindowUntoldS, kStrides * std::max(period_s, kStrideS)});
    const double gap_s = static_cast<double>(out.gap_samples_max) * period_s * (1 + kPeriodShare) +
                         sample_errors(machine, 0, 0).latch_jitter_s;
    for (std::uint32_t i = 0; i < out.axis_count; ++i) {
        const Axis& axis = machine.axes[i];
        const double width = kWidthCounts * count[i] + 2 * axis.position_error;
        const double unit = axis.kind == AxisKind::rotary ? kRadADegree : 1.0;
        window_s = std::max(window_s, 2 * width / (kSlowest * unit));
        out.unlimited[i] = axis.unlimited;
        out.width[i] = width * kRoundings;
        // The axis itself: what the two errors hide, and what it may do between two samples.
        out.true_width[i] = width + count[i] + 2 * axis.position_error + 2 * axis.following_error +
                            axis.acceleration_max * gap_s * gap_s / 8;
        // A whole turn between two samples would look like none.
        is_seen = is_seen && !(axis.unlimited && axis.speed_max * gap_s + width >= 2 * kPi);
    }
    // The board's period may be kPeriodShare shorter than the stated one.
    out.window_samples =
        is_seen ? static_cast<std::uint64_t>(std::ceil(window_s / (period_s * (1 - kPeriodShare))))
                : kNeverStands;
    return out;
}

void begin_standstill(Standstill& state, std::int64_t after_us) noexcept {
    state = {};
    state.after_us = after_us;
}

void note_standstill(Standstill& state, const StandstillRules& rules, const AxisSnapshot& snapshot,
                     bool is_reported_still) noexcept {
    const std::uint64_t sample = snapshot.sample;
    const bool follows =
        state.has_sample && sample > state.newest && sample - state.newest <= rules.gap_samples_max;
    if (!follows) {
        begin_standstill(state, state.after_us);
        state.since = sample;
    }
    if (!can_stand(rules) || !is_reported_still || !is_quiet(rules, snapshot) ||
        snapshot.latched_us - rules.latched_age_us <= state.after_us) {
        begin_standstill(state, state.after_us);
        return;
    }
    const std::uint64_t number = sample / part_samples(rules);
    Standstill::Part& part = state.parts[number % state.parts.size()];
    const bool is_new = part.number != number;
    part.number = number;
    for (std::uint32_t i = 0; i < rules.axis_count; ++i) {
        const double position = unwrapped(state, rules, snapshot, i);
        part.low[i] = is_new ? position : std::min(part.low[i], position);
        part.high[i] = is_new ? position : std::max(part.high[i], position);
    }
    state.has_sample = true;
    state.newest = sample;
    state.newest_us = snapshot.latched_us;
}

std::uint32_t moving_axis(const Standstill& state, const StandstillRules& rules) noexcept {
    if (!can_stand(rules) || !state.has_sample) {
        return kNoIndex;
    }
    const std::uint64_t samples = part_samples(rules);
    const std::uint64_t last = state.newest / samples;
    const std::uint64_t first =
        (state.newest - std::min(state.newest, rules.window_samples)) / samples;
    for (std::uint32_t i = 0; i < rules.axis_count; ++i) {
        double low = state.last[i] + 2 * kPi * state.turns[i], high = low;
        for (const Standstill::Part& part : state.parts) {
            if (part.number >= first && part.number <= last) {
                low = std::min(low, part.low[i]);
                high = std::max(high, part.high[i]);
            }
        }
        if (!(high - low <= rules.width[i])) {
            return i;
        }
    }
    return kNoIndex;
}

bool stands(const Standstill& state, const StandstillRules& rules, std::int64_t now_us) noexcept {
    return can_stand(rules) && state.has_sample &&
           state.newest - state.since >= rules.window_samples &&
           now_us - state.newest_us <= rules.age_us_max && moving_axis(state, rules) == kNoIndex;
}

}  // namespace axg
