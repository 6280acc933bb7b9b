// SPDX-License-Identifier: Apache-2.0
// The section `can` of a machine file: which frames carry the axis positions, the permit and the
// stop.
#pragma once

namespace axg {

class MapReader;
struct MachineDraft;

/// After `axes`. Faults go to draft.faults; what could be read is in draft.machine.can.
void read_can(MapReader& top, MachineDraft& draft);

}  // namespace axg
