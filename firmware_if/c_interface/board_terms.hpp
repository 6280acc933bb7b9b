// SPDX-License-Identifier: Apache-2.0
// The values of the machine file that a board needs, in the types of the C interface.
#pragma once

#include "core/machine/configuration_hashes.hpp"
#include "core/machine/machine.hpp"
#include "firmware_if/axguard.h"

namespace axg {

[[nodiscard]] axg_terms board_terms(const Machine& machine,
                                    const ConfigurationHashes& hashes) noexcept;

}  // namespace axg
