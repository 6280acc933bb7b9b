// SPDX-License-Identifier: Apache-2.0
// All that a guard needs of a machine on the CPU, made in one place, with one message for each part
// that is missing.
#pragma once

#include <optional>
#include <string_view>

#include "core/collision/containment.hpp"
#include "core/collision/cpu_engine.hpp"
#include "firmware_if/setup/cycle_parts.hpp"
#include "firmware_if/setup/guard_engine.hpp"

namespace axg {

struct GuardParts {
    /// `loaded` must outlive it.
    /// @param is_stoppable  false: contact mode, which has neither certificate nor speed cap
    GuardParts(const LoadedMachine& loaded, bool is_stoppable)
        : GuardParts(loaded, is_stoppable, loaded.machine.guard.speed_cap) {}
    GuardParts(const LoadedMachine& loaded, bool is_stoppable, bool wants_cap);
    GuardParts(const GuardParts&) = delete;  // the containment test uses the trees of the engine
    GuardParts& operator=(const GuardParts&) = delete;

    /// Empty: no part is missing. Else names the missing part, and the remedy.
    [[nodiscard]] std::string_view fault() const noexcept;

    std::optional<CpuEngine> engine;
    std::optional<ContainmentTest> containment_test;
    CycleParts cycle;
};

}  // namespace axg
