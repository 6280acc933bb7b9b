// SPDX-License-Identifier: Apache-2.0
// Inline signals: where in a foreign board's frames each axis position stands.
#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace axg {

class MapReader;
struct CanLayout;
struct MachineDraft;

struct NamedId {
    std::uint32_t id;
    std::string name;
};

/// `signals` and `signal_frame_bytes`: one signal for each axis, inside its frame, overlapping no
/// other, and wide enough for the axis' travel. Without format: signals both keys are faults.
void read_signals(MapReader& can, MachineDraft& draft);

/// No signal may come under an identifier that means something else.
void check_signal_ids(MapReader& can, const CanLayout& layout, std::span<const NamedId> others);

}  // namespace axg
