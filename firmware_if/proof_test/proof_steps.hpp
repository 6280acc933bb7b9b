// SPDX-License-Identifier: Apache-2.0
// The steps of a proof test: what the person does, and what the status of the guard has to show
// afterwards. No clock and no socket: proof_test_command.cpp reads and waits.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace axg {

/// The part of a status line that steps are judged by. Keys: docs/reference/axguardd.md, "State
/// without root".
struct GuardSight {
    std::string bus, machine, configuration, phase, cause, reason;
    std::string pair;  // "a - b"; empty: none
    std::string withheld, withheld_pair;
    std::uint64_t age_ms = 0, permits = 0;
    bool stands = false, is_confirmed = false;
    bool has_view = false;  // false: the bus thread has shown nothing yet
};

/// Texts are escaped for a terminal. Empty: a key is missing or has another type.
[[nodiscard]] std::optional<GuardSight> sight_of(std::string_view status_line);

/// State and reason in one line.
[[nodiscard]] std::string summary_of(const GuardSight& sight);

enum class StepEnd : std::uint8_t { waiting, passed, failed };

/// Guard and expectation at one look during a step.
struct ProofView {
    const GuardSight& now;
    const GuardSight& before;  // when the step began
    bool was_gone = false;     // the guard did not reply since the step began
    std::string_view pair;     // of the known place; empty: any
};

struct ProofStep {
    const char* name;
    const char* task;                    // empty: nothing to do
    StepEnd (*judge)(const ProofView&);  // null: only the person's answer counts
    const char* question;                // to be answered with yes; empty: none
};

[[nodiscard]] std::span<const ProofStep> proof_steps() noexcept;

}  // namespace axg
