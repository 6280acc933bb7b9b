// SPDX-License-Identifier: Apache-2.0
// Why no guard may run live on a machine, wherever it runs: what its file promises is too little
// for a permit to end, or for a stop to be confirmed. And what a person has to know of one that
// may. For everyone who makes a guard of a bus.
#pragma once

#include <string>
#include <vector>

#include "core/machine/machine.hpp"

namespace axg {

/// Each with what to change in the machine file; empty: a guard may run.
[[nodiscard]] std::vector<std::string> live_refusals(const Machine& machine);
/// What the file gives up that a guard usually has.
[[nodiscard]] std::vector<std::string> live_warnings(const Machine& machine);

}  // namespace axg
