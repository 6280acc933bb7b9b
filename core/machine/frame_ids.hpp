// SPDX-License-Identifier: Apache-2.0
// Identifiers that a machine file states by name, a row each: reader, checks, effective file, and
// the guard's filter walk them. A new message of the guard is a row here and a member of CanLayout.
// Claim: no two rows share a member (static_assert).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/machine/can_layout.hpp"

namespace axg {

/// Which boards the frames go with.
enum class FrameUse : std::uint8_t {
    always,
    sync,    // those with SYNC; the machine file has the identifier in any case
    hashes,  // those which exchange hashes with the guard
    counter  // those with a sample counter
};

struct FrameId {
    const char* key;  // below can.ids
    std::uint32_t CanLayout::*id;
    FrameUse use;
    bool is_of_guard;  // only the guard sends it
};

/// In the order of the canonical text, which the hashes cover, for rows of FrameUse::counter.
inline constexpr std::array<FrameId, 12> kFrameIds{{
    {"sync", &CanLayout::sync_id, FrameUse::sync, false},
    {"permit", &CanLayout::permit_id, FrameUse::always, true},  // its twin has the next one
    {"stop", &CanLayout::stop_id, FrameUse::always, false},
    {"emergency", &CanLayout::emergency_id, FrameUse::always, true},
    {"heartbeat_in", &CanLayout::heartbeat_in_id, FrameUse::sync, false},
    {"heartbeat_out", &CanLayout::heartbeat_out_id, FrameUse::always, true},
    {"hashes_in", &CanLayout::hashes_in_id, FrameUse::hashes, false},
    {"hashes_out", &CanLayout::hashes_out_id, FrameUse::hashes, true},
    {"session_in", &CanLayout::session_in_id, FrameUse::counter, false},
    {"hints", &CanLayout::hints_id, FrameUse::counter, true},
    {"operator_in", &CanLayout::operator_in_id, FrameUse::counter, false},
    {"operator_out", &CanLayout::operator_out_id, FrameUse::counter, true},
}};

static_assert(
    [] {
        for (std::size_t i = 0; i < kFrameIds.size(); ++i) {
            for (std::size_t j = 0; j < i; ++j) {
                if (kFrameIds[i].id == kFrameIds[j].id) {
                    return false;
                }
            }
        }
        return true;
    }(),
    "each row reads a member of its own");

/// Whether such frames are on the bus.
[[nodiscard]] inline bool is_used(const CanLayout& can, FrameUse use) noexcept {
    switch (use) {
        case FrameUse::sync:
            return has_sync(wire_of(can));
        case FrameUse::hashes:
            return can.hashes_in_id != 0 && can.hashes_out_id != 0;
        case FrameUse::counter:
            return has_sample_counter(can);
        default:
            return true;
    }
}
/// Whether the machine file states the identifier.
[[nodiscard]] inline bool is_stated(const CanLayout& can, FrameUse use) noexcept {
    return use == FrameUse::sync || is_used(can, use);
}

}  // namespace axg
