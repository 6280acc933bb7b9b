// SPDX-License-Identifier: Apache-2.0
// A machine file with every key that it left out, for people: what is in force, and what of it
// not stated.
#pragma once

#include <string>

#include "config/text/machine_text.hpp"
#include "core/machine/machine.hpp"

namespace axg {

/// The file's own values as written, then each absent key with the value in force, marked
/// "# default"; where absence is the value, a comment. Reads back to the same configuration hash
/// in the folder of the file.
/// @param machine  as parse_machine() read it from `source`
[[nodiscard]] std::string effective_yaml(const MachineText& source, const Machine& machine);

}  // namespace axg
