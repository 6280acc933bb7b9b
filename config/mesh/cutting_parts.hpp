// SPDX-License-Identifier: Apache-2.0
// What of a tool is checked against stock: all that does not cut.
#pragma once

#include "config/mesh/load_meshes.hpp"
#include "core/machine/machine.hpp"

namespace axg {

/// Gives each checked pair of the tool and a stock body, for each tool with cutting sections, a
/// surface of its own: the sections that do not cut, each a closed shell as it is in the whole
/// tool. To be called once, after load_meshes() has found no fault.
void part_cutters(Machine& machine, MachineMeshes& meshes);

}  // namespace axg
