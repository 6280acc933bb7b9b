// SPDX-License-Identifier: Apache-2.0
#include "core/reach/machine_stop.hpp"

namespace axg {
namespace {

constexpr std::uint64_t kSeenRestStrides = 16;  // needed to detect rest

}  // namespace

void begin_machine_stop(MachineStop& stop, const LimitFact& cause, std::uint64_t stride) noexcept {
    if (!stop.is_on) {
        stop = {.is_on = true, .begin = stride, .cause = cause};
    }
    if (cause.kind == LimitKind::stopping && !stop.is_too_hard) {
        stop.is_too_hard = true;
        stop.cause = cause;
    }
}

LimitFact follow_machine_stop(MachineStop& stop, const MachineStopRules& rules, MachineRest rest,
                              std::uint64_t stride) noexcept {
    if (!stop.is_on) {
        return {};
    }
    const bool has_to_stop_all = rules.stops_all || stop.is_too_hard;
    if (!rest.is_any_stopping && (rest.are_all_at_rest || !has_to_stop_all)) {
        stop = {};
        return {};
    }
    // A frozen command stops all counts at once: no drive brakes, so no braking time is allowed.
    const std::uint64_t braking = stop.is_too_hard ? 0 : rules.braking_strides;
    const bool is_overdue =
        stride > stop.begin + braking + rules.reaction_strides + kSeenRestStrides;
    return has_to_stop_all && is_overdue ? stop.cause : LimitFact{};
}

}  // namespace axg
