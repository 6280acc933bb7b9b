// SPDX-License-Identifier: Apache-2.0
// How long the longest cycle of a plan takes on the processor at hand: snapshot to decision over
// the constructed longest cycle (core/worst_case/longest_cycle.hpp). us.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/collision/cpu_engine.hpp"
#include "core/machine/cycle_work.hpp"
#include "core/worst_case/longest_cycle.hpp"
#include "firmware_if/setup/loaded_machine.hpp"

namespace axg {

/// Caches at the start of a cycle: all data and code, no data, neither code nor data, or the last
/// while another core copies memory.
enum class CacheCondition : std::uint8_t { warm, cold, code_cold, beside_copier };
inline constexpr std::array kCacheConditions{CacheCondition::warm, CacheCondition::cold,
                                             CacheCondition::code_cold,
                                             CacheCondition::beside_copier};
[[nodiscard]] const char* name_of(CacheCondition condition) noexcept;

inline constexpr std::uint32_t kCycleRepeats = 5;  // of which the least counts

struct CycleMeasureOptions {
    LaneSet lanes = LaneSet::widest;
    std::vector<CacheCondition> conditions{kCacheConditions.begin(), kCacheConditions.end()};
    std::uint32_t groups_of_repeats = 1;  // of each layout, shape and condition
    std::vector<CycleShape> shapes{};     // their layouts too; empty: all there are
};

/// Microseconds on the wall's clock and of the thread's own time.
struct CycleTime {
    double wall_us = 0, cpu_us = 0;
};

struct CycleLine {
    CycleShape shape;
    CacheCondition condition = CacheCondition::warm;
    CycleWork work{};
    CycleTime least{};              // of five, the longest group of five
    std::vector<double> wall_us{};  // every cycle
};

struct CycleMeasurement {
    std::string lanes;
    CyclePlan plan;
    std::uint32_t tasks = 0;       // pairs with each tool
    std::size_t memory_bytes = 0;  // of the trees: the machine's size
    CycleTime posing{};            // the same cycle over an engine that proves nothing, least
    std::vector<CycleLine> lines;
    std::size_t longest = 0;  // which line, by the wall's clock

    [[nodiscard]] double longest_us() const noexcept { return lines[longest].least.wall_us; }
};

/// cycle_shapes in the layouts that were longest on every machine so far.
[[nodiscard]] std::vector<CycleShape> longest_shapes(const CyclePlan& plan, std::uint32_t tasks,
                                                     bool asks_twice);

/// Host time of a cycle over a GPU engine that replies at once, from snapshot to decision, us: the
/// longest of all conditions, numbers of open pairs, and stages in which they are proven. Excludes
/// the launches. Empty, with `fault` set: no memory.
/// @param host_stages  number of first stages that the CPU engine runs, with their lists full
/// @param poses_parts  as Engine::run_parts; else the host poses every box
[[nodiscard]] std::optional<double> measure_host_us(const LoadedMachine& loaded,
                                                    const CyclePlan& plan,
                                                    std::uint32_t host_stages, bool poses_parts,
                                                    std::string& fault);

/// Empty, with `fault` set: no such lanes, no memory, lists that do not go together, or a machine
/// whose boxes end before the plan does.
/// @param loaded  its guard is stoppable; its travel proofs are not used
[[nodiscard]] std::optional<CycleMeasurement> measure_cycle(const LoadedMachine& loaded,
                                                            const CyclePlan& plan,
                                                            const CycleMeasureOptions& options,
                                                            std::string& fault);

}  // namespace axg
