// SPDX-License-Identifier: Apache-2.0
// Decides whether a guard may start on this machine. Input: figures measured just before; output:
// the verdict. Uses no clock, file or device. A check whose figure is missing has failed.
// The checks, and what they do not show: docs/reference/axguardd.md, "Admission".
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/guard/time_limits.hpp"
#include "core/machine/cycle_work.hpp"
#include "firmware_if/live/live_view.hpp"
#include "firmware_if/system/fitness.hpp"

namespace axg {

enum class AdmissionCheck : std::uint8_t {
    system,        // what doctor finds
    latency,       // how late a thread wakes up
    engine,        // the longest cycle of queries
    cycle,         // both together within the deadline
    known_answer,  // the two queries with known answers
    memory,        // what is reserved and locked against what there is
};
inline constexpr std::array kAdmissionChecks{AdmissionCheck::system,       AdmissionCheck::latency,
                                             AdmissionCheck::engine,       AdmissionCheck::cycle,
                                             AdmissionCheck::known_answer, AdmissionCheck::memory};
inline constexpr std::size_t kAdmissionCount = kAdmissionChecks.size();
[[nodiscard]] const char* to_text(AdmissionCheck check) noexcept;

/// Wake-ups of a thread with the bus thread's priority and processor.
struct WakeUpFigures {
    std::uint64_t count = 0;
    std::int64_t p99_ns = 0, latest_ns = 0;
};

/// Cycles of the whole chain at positions spread over the travel, at rest and at full speed, caches
/// cold, in the engine thread's place; and the constructed longest one.
struct CycleFigures {
    std::string engine;  // "cpu, avx2 lanes", or the GPU's name
    std::uint32_t count = 0, proven_count = 0;
    double proven_us = 0;  // the longest that would have led to a permit: it has the deadline
    // The longest of all. A cycle that is not proven sends no permit, late or not; but the guard
    // treats an engine without a result for as long as a permit lasts as lost.
    double longest_us = 0;
    std::uint32_t queries_max = 0;    // of a cycle; contact mode: 0
    double worst_case_us = 0;         // every list full; 0: contact mode
    std::optional<CyclePlan> plan{};  // with those lists; empty: contact mode
};

struct MemoryFigures {
    std::uint64_t reserved_bytes = 0;   // by the engine, already
    std::uint64_t more_bytes = 0;       // that the threads will reserve
    std::uint64_t available_bytes = 0;  // without swapping
    std::uint64_t mapped_bytes = 0;     // by the process: all of it is locked
    std::uint64_t lock_limit_bytes = 0;
    std::uint64_t device_bytes = 0;  // of a GPU, reserved already
};

struct AdmissionFigures {
    TimeLimits times{};
    std::optional<std::vector<Finding>> system;
    std::optional<WakeUpFigures> wake_ups;
    std::optional<CycleFigures> cycles;
    std::optional<bool> passes_known_answer;
    std::optional<MemoryFigures> memory;
};

struct AdmissionLine {
    AdmissionCheck check = AdmissionCheck::system;
    bool is_passed = false;
    std::optional<double> margin;  // share of its room that is left, where it has one
    std::string found;             // in words
    std::string mend;              // what to change; empty where it passed
};

struct AdmissionVerdict {
    std::array<AdmissionLine, kAdmissionCount> lines;  // in the order of kAdmissionChecks
    std::int64_t sample_us = 0;
    double margin = 0;  // the least of all lines; 0 where one failed

    [[nodiscard]] bool is_fit() const noexcept;
    /// All that failed are among these.
    [[nodiscard]] bool is_waived_by(const std::vector<std::string>& names) const;
};

[[nodiscard]] AdmissionGauge gauge_of(const AdmissionVerdict& verdict) noexcept;

[[nodiscard]] AdmissionVerdict judge_admission(const AdmissionFigures& figures);

/// "fit for 1000 Hz with margin 38 % (cycle)", or "not fit for 1000 Hz because of latency, engine".
[[nodiscard]] std::string to_text(const AdmissionVerdict& verdict);

}  // namespace axg
