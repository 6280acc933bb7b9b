// SPDX-License-Identifier: Apache-2.0
// Checks whether this host meets the guard's timing: findings, faults, and the command that
// corrects each. Reads /proc and /sys under a root folder, so that it can check a copy, or a tree
// made by a test, like the host itself.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "firmware_if/system/can_link.hpp"

namespace axg {

/// warn: it may be late; bad: the guard will not run, or not in time.
enum class Fitness : std::uint8_t { ok, warn, bad };
[[nodiscard]] const char* to_text(Fitness fitness) noexcept;

struct Finding {
    Fitness fitness = Fitness::bad;
    std::string subject;  // kernel, swap, can0 ...
    std::string found;    // what there is
    std::string mend;     // a command; empty where there is nothing to do
};

struct SystemRequest {
    std::string root;                   // empty: this machine
    int bus_cpu = -1, engine_cpu = -1;  // as passed to `run`; -1: none
    int priority = 80;
};

/// Kernel, clocks, processors, memory, limits, GPU, time since boot.
[[nodiscard]] std::vector<Finding> check_system(const SystemRequest& request);

/// A part of it: the processors of the bus thread and the engine thread, in this order. The advice
/// names processors that are online, isolated ones first, and never the first of the machine.
[[nodiscard]] std::vector<Finding> check_processors(const SystemRequest& request);

/// @param link  its state from rtnetlink; empty: not requested, as for a copy
[[nodiscard]] std::vector<Finding> check_bus(const std::string& root, const std::string& bus,
                                             const std::optional<CanLink>& link);

/// A file of /proc or /sys without the blanks at its end; empty: it is not there.
[[nodiscard]] std::string read_small_file(const std::string& path);
inline constexpr int kCapIpcLock = 14, kCapSysNice = 23;
/// Whether this process has it, by /proc/self/status.
[[nodiscard]] bool has_capability(const std::string& root, int capability);
/// The numbers of a list as the kernel writes it, such as "2-3,5".
[[nodiscard]] std::vector<int> parse_processors(const std::string& list);

}  // namespace axg
