// SPDX-License-Identifier: Apache-2.0
// axguardd latency-test: how late this machine wakes a thread up, and which cycle that is fit for.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>

namespace axg {

/// The share of a period that a late wake-up may take; as much as a SYNC may be off its period
/// (docs/protocol.md, rule 6).
inline constexpr std::int64_t kWakeUpShare = 5;

/// The shortest period that such a lateness leaves fit, us.
[[nodiscard]] constexpr std::int64_t fit_period_us(std::int64_t latest_ns) noexcept {
    return latest_ns <= 0 ? 1 : (latest_ns * kWakeUpShare + 999) / 1000;
}

void add_latency_test(CLI::App& app, int& exit_code);

}  // namespace axg
