// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/setup/cycle_parts.hpp"

#include "firmware_if/setup/guard_engine.hpp"

namespace axg {

namespace {

bool has_advisory(const LoadedMachine& loaded, bool is_stoppable, bool wants_cap) noexcept {
    return is_stoppable && (wants_cap || loaded.machine.guard.cap != CapPromise::none);
}

}  // namespace

CycleParts::CycleParts(const LoadedMachine& loaded, bool is_stoppable, bool wants_cap)
    : stop_certificate_(is_stoppable ? make_stop_certificate(loaded) : std::nullopt),
      speed_advisory_(has_advisory(loaded, is_stoppable, wants_cap)
                          ? SpeedAdvisory::create(loaded.machine)
                          : std::nullopt),
      margin_advisory_(has_clearance_levels(loaded.machine) ? MarginAdvisory::create(loaded.machine)
                                                            : std::nullopt),
      has_memory_((stop_certificate_ || !is_stoppable) &&
                  (speed_advisory_ || !has_advisory(loaded, is_stoppable, wants_cap)) &&
                  (margin_advisory_ || !has_clearance_levels(loaded.machine))) {}

}  // namespace axg
