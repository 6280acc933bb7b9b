// SPDX-License-Identifier: Apache-2.0
// The part that ends the motion of a machine when permits end, and whether a proof holds for it.
// One decision for every program that guards, checks or replays. Source:
// docs/reference/machine-file.md, "Who obeys the permit".
#pragma once

#include <string>

#include "core/machine/machine.hpp"

namespace axg {

/// The reason why no part obeys the permits of this machine within the time that its certificates
/// suppose, and the change to make; empty: the board obeys them.
[[nodiscard]] std::string obeyed_by_refusal(const Machine& machine);

}  // namespace axg
