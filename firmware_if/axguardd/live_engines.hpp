// SPDX-License-Identifier: Apache-2.0
// The engine of a live guard, and its containment test: created and chosen at
// start.
#pragma once

#include <optional>
#include <string>

#include "core/collision/containment.hpp"
#include "core/collision/cpu_engine.hpp"
#include "firmware_if/setup/choose_engine.hpp"
#include "firmware_if/setup/choose_plan.hpp"
#include "firmware_if/setup/loaded_machine.hpp"

namespace axg {

struct LiveEngines {
    /// @param word  of the option; empty: the machine file's
    LiveEngines(const LoadedMachine& loaded, const std::string& word, bool is_stoppable);
    LiveEngines(const LiveEngines&) = delete;  // the containment test uses the trees of `cpu`
    LiveEngines& operator=(const LiveEngines&) = delete;

    [[nodiscard]] Engine engine() { return chosen.engine(*cpu); }

    std::optional<CpuEngine> cpu;
    std::optional<ContainmentTest> containment_test;
    // For a stoppable guard. Empty: it could not be measured, and no guard is admitted.
    std::optional<ChosenPlan> plan;
    ChosenEngine chosen;  // without a refusal where all of them are there
};

/// Prints on stderr which engine was chosen and why, or why none. Returns the exit code.
[[nodiscard]] int log_engines(const LiveEngines& engines);

}  // namespace axg
