// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/setup/guard_parts.hpp"

namespace axg {

GuardParts::GuardParts(const LoadedMachine& loaded, bool is_stoppable, bool wants_cap)
    : engine(make_engine(loaded)),
      containment_test(engine ? make_containment_test(loaded, *engine) : std::nullopt),
      cycle(loaded, is_stoppable, wants_cap) {}

std::string_view GuardParts::fault() const noexcept {
    if (!engine) {
        return kNoLaneSet;
    }
    if (!containment_test) {
        return kNoMemoryForContainment;
    }
    return cycle.has_memory() ? std::string_view() : kNoMemoryForProofs;
}

}  // namespace axg
