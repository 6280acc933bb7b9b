// SPDX-License-Identifier: Apache-2.0
// A stop of the board's own: from the excess that only such a stop explains until all axes rest. It
// stops all axes within H(n_max); one that does not is a broken limit. Pure; times in strides.
// Source: docs/theory/certificate.md, "A stop of the board's own".
#pragma once

#include <cstdint>

#include "core/certificate/limit_fact.hpp"

namespace axg {

struct MachineStopRules {
    bool stops_all = false;              // by the contract of the board
    std::uint64_t reaction_strides = 0;  // H(n_max): from the first axis to the last that brakes
    std::uint64_t braking_strides = 0;   // the softest stop of the slowest axis
};

struct MachineStop {
    bool is_on = false;
    bool is_too_hard = false;  // harder than any drive brakes: only where all axes' counts stop too
    std::uint64_t begin = 0;   // stride of the first excess
    LimitFact cause;           // what was broken if rest does not follow
};

/// How the axes are at this stride.
struct MachineRest {
    bool is_any_stopping = false;  // an axis is in a stop of its own
    bool are_all_at_rest = false;
};

/// One axis shows an excess that braking explains.
void begin_machine_stop(MachineStop& stop, const LimitFact& cause, std::uint64_t stride) noexcept;

/// Returns the cause where rest is overdue.
[[nodiscard]] LimitFact follow_machine_stop(MachineStop& stop, const MachineStopRules& rules,
                                            MachineRest rest, std::uint64_t stride) noexcept;

}  // namespace axg
