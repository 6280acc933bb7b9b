// SPDX-License-Identifier: Apache-2.0
// A stop of the board's own: from the excess that only such a stop explains until all axes rest.
// If the board has to stop all axes, they rest within the longest stop plus H(n_max); otherwise the
// excess is a broken limit. Pure; times in strides.
// Source: docs/theory/certificate.md, "A stop of the board's own".
#pragma once

#include <cstdint>

#include "core/reach/limit_fact.hpp"

namespace axg {

struct MachineStopRules {
    bool stops_all = false;              // the board's contract requires it
    std::uint64_t reaction_strides = 0;  // H(n_max): from the first braking axis to the last
    std::uint64_t braking_strides = 0;   // the softest stop of the slowest axis
};

struct MachineStop {
    bool is_on = false;
    bool is_too_hard = false;  // harder than any drive brakes: valid only if all counts stop, too
    std::uint64_t begin = 0;   // stride of the first excess
    LimitFact cause;           // the broken limit if rest does not follow
};

/// State of the axes at this stride.
struct MachineRest {
    bool is_any_stopping = false;  // an axis is in a stop of its own
    bool are_all_at_rest = false;
};

/// Notes that one axis shows an excess that braking explains.
void begin_machine_stop(MachineStop& stop, const LimitFact& cause, std::uint64_t stride) noexcept;

/// Returns the cause if rest is overdue.
[[nodiscard]] LimitFact follow_machine_stop(MachineStop& stop, const MachineStopRules& rules,
                                            MachineRest rest, std::uint64_t stride) noexcept;

}  // namespace axg
