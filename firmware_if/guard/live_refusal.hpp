// SPDX-License-Identifier: Apache-2.0
// Reasons why no guard may run live on a machine, on any computer: its file promises too little for
// a permit to end, or for a stop to be confirmed. And warnings about a machine that may run. For
// all programs that construct a guard of a bus.
#pragma once

#include <string>
#include <vector>

#include "core/machine/machine.hpp"

namespace axg {

/// Each with what to change in the machine file; empty: a guard may run.
[[nodiscard]] std::vector<std::string> live_refusals(const Machine& machine);
/// Protections that a guard usually has and that the file omits.
[[nodiscard]] std::vector<std::string> live_warnings(const Machine& machine);

}  // namespace axg
