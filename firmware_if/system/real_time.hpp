// SPDX-License-Identifier: Apache-2.0
// Real-time settings of a thread. Needs no capability, only rlimits (RTPRIO, MEMLOCK);
// a refused setting returns a text with the remedy, and the program continues: the permit ends by
// itself if the thread is late.
#pragma once

#include <string>

namespace axg {

/// All pages of the process stay in memory. Empty: done.
[[nodiscard]] std::string lock_memory();
/// SCHED_FIFO for the calling thread. Empty: done.
[[nodiscard]] std::string take_priority(int priority);
/// The calling thread stays on one processor. Empty: done, or `cpu` is negative.
[[nodiscard]] std::string stay_on_cpu(int cpu);

}  // namespace axg
