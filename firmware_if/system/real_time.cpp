// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/system/real_time.hpp"

#include <sched.h>
#include <sys/mman.h>

#include <cerrno>
#include <cstring>

namespace axg {

std::string lock_memory() {
    if (mlockall(MCL_CURRENT | MCL_FUTURE) == 0) {
        return {};
    }
    return std::string("cannot lock memory (mlockall): ") + std::strerror(errno) +
           ". Raise the limit: ulimit -l unlimited, or LimitMEMLOCK=infinity in the unit";
}

std::string take_priority(int priority) {
    const sched_param wanted{.sched_priority = priority};
    if (sched_setscheduler(0, SCHED_FIFO, &wanted) == 0) {
        return {};
    }
    return "cannot set real-time priority " + std::to_string(priority) + ": " +
           std::strerror(errno) + ". Raise the limit: ulimit -r 99, or LimitRTPRIO=99 in the unit";
}

std::string stay_on_cpu(int cpu) {
    if (cpu < 0) {
        return {};
    }
    cpu_set_t set;
    CPU_ZERO(&set);
    if (cpu < CPU_SETSIZE) {
        CPU_SET(static_cast<unsigned>(cpu), &set);
    }
    if (sched_setaffinity(0, sizeof set, &set) == 0) {
        return {};
    }
    return "cannot run a thread on processor " + std::to_string(cpu) + ": " + std::strerror(errno) +
           ". List the processors: nproc --all, taskset -cp 1";
}

}  // namespace axg
