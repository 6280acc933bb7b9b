// SPDX-License-Identifier: Apache-2.0
// The plan of a guard's computer, from the verdict that `axguardd admit` or `run` stored there.
// With it another computer proves the same samples. docs/reference/axguardd.md, "Admission".
#pragma once

#include <optional>
#include <string>

#include "core/machine/cycle_work.hpp"
#include "firmware_if/setup/loaded_machine.hpp"

namespace axg {

struct AdmittedPlan {
    CyclePlan plan;
    std::string engine, host, date;
    double longest_us = 0;  // of its longest cycle
    bool is_fit = false;
};

/// Reads the verdict of a guard in stoppable mode with the same machine file.
/// @return  empty with `fault` set: not readable, no plan in it, or of another configuration
[[nodiscard]] std::optional<AdmittedPlan> read_admitted_plan(const std::string& path,
                                                             const LoadedMachine& loaded,
                                                             std::string& fault);

/// Whether every sample that `small` has the lists for has them with `large`, too: as many stages,
/// and of each stage no list and no number of queries that is less.
[[nodiscard]] bool is_within(const CyclePlan& small, const CyclePlan& large) noexcept;

}  // namespace axg
