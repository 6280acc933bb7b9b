// SPDX-License-Identifier: Apache-2.0
// axguardd latency-test: measures thread wake-up latency, and the period that it allows.
#pragma once

#include <cstdint>

#include "core/base/time_histogram.hpp"

namespace axg {

class Command;
class CommandLine;

/// A wake-up may be late by 1/kWakeUpShare of a period, as much as a SYNC may be off its period
/// (docs/reference/protocol.md, rule 6).
inline constexpr std::int64_t kWakeUpShare = 5;

/// The shortest period that such a latency allows, us.
[[nodiscard]] constexpr std::int64_t fit_period_us(std::int64_t latest_ns) noexcept {
    return latest_ns <= 0 ? 1 : (latest_ns * kWakeUpShare + 999) / 1000;
}

/// CLOCK_MONOTONIC.
[[nodiscard]] std::int64_t monotonic_ns() noexcept;

/// How late the calling thread wakes up on an absolute schedule. Each wake-up is late by its
/// distance from the instant that was meant, so that one long sleep counts for every period in it,
/// as it would for a guard.
void measure_lateness(std::int64_t period_us, std::uint64_t count,
                      TimeHistogram& lateness) noexcept;

/// --cpu and --priority of a thread that measures.
void add_thread_options(const Command& command, int& cpu, int& priority);

void add_latency_test(CommandLine& line);

}  // namespace axg
