// SPDX-License-Identifier: Apache-2.0
// Promises of board and axes that a machine file does not state: the guard assumes a default.
// Computes how much farther a stop leads if the default is wrong. Pure.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/machine/machine.hpp"

namespace axg {

/// One key, and a value that promises less. Cost: how much farther a stop from rapid leads with
/// that value, for the shortest permit.
struct UnstatedPromise {
    std::string key;         // "guard.board_reaction_ms"
    std::string assumed;     // "2"
    std::string cautious;    // "4"
    std::uint32_t axis = 0;  // that it costs most; a linear one, where there is one
    double cost = 0;         // mm, of a rotary axis degrees
};

/// In a fixed order; none where the default is the cautious value.
[[nodiscard]] std::vector<UnstatedPromise> unstated_promises(const Machine& machine);

/// "guard.board_reaction_ms: 2 assumed; with 4 X stops 0.333 mm later".
[[nodiscard]] std::string format_promise(const Machine& machine, const UnstatedPromise& promise);

}  // namespace axg
