// SPDX-License-Identifier: Apache-2.0
// Selects the part of a tool that is checked against stock: all sections that do not cut.
#pragma once

#include "config/mesh/load_meshes.hpp"
#include "core/machine/machine.hpp"

namespace axg {

/// Gives each checked pair of the tool and a stock body, for each tool with cutting sections, a
/// surface of its own: the sections that do not cut, each a closed shell as it is in the whole
/// tool. Call it once, after load_meshes() has found no fault.
void part_cutters(Machine& machine, MachineMeshes& meshes);

}  // namespace axg
