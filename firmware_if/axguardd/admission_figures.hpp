// SPDX-License-Identifier: Apache-2.0
// Measures the figures of an admission, on threads with the priorities and processors that the
// guard's own will have. Needs the stated seconds for the wake-ups, and about one for the cycles.
#pragma once

#include <cstdint>
#include <string>

#include "core/collision/containment.hpp"
#include "core/collision/engine.hpp"
#include "firmware_if/axguardd/admission.hpp"
#include "firmware_if/axguardd/live_engines.hpp"
#include "firmware_if/setup/loaded_machine.hpp"
#include "firmware_if/system/fitness.hpp"

namespace axg {

/// As passed to `run`.
struct AdmissionRun {
    std::string bus;
    bool is_stoppable = true;
    int bus_priority = 80, engine_priority = 70, bus_cpu = -1, engine_cpu = -1;
    double seconds = 2;  // of wake-ups
};

/// A figure that cannot be measured is left empty, which `judge_admission` treats as failed.
[[nodiscard]] AdmissionFigures measure_admission(const AdmissionRun& run,
                                                 const LoadedMachine& loaded, LiveEngines& engines);

}  // namespace axg
