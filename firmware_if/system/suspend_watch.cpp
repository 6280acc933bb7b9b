// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/system/suspend_watch.hpp"

#include <algorithm>
#include <ctime>

namespace axg {
namespace {

std::int64_t microseconds(clockid_t clock) noexcept {
    timespec now{};
    clock_gettime(clock, &now);
    return std::int64_t{now.tv_sec} * 1'000'000 + now.tv_nsec / 1000;
}

}  // namespace

SuspendClocks system_suspend_clocks() noexcept {
    return {.monotonic_us = []() noexcept { return microseconds(CLOCK_MONOTONIC); },
            .boottime_us = []() noexcept { return microseconds(CLOCK_BOOTTIME); }};
}

SuspendWatch::SuspendWatch(const SuspendClocks& clocks) noexcept : clocks_(clocks) {
    [[maybe_unused]] const bool is_first = has_slept();
}

/// Bounds the time asleep, however long the thread was held between the calls: from above with the
/// monotonic clock read before CLOCK_BOOTTIME, from below with the one read after it.
bool SuspendWatch::has_slept() noexcept {
    const std::int64_t before_us = clocks_.monotonic_us();
    const std::int64_t boot_us = clocks_.boottime_us();
    const std::int64_t after_us = clocks_.monotonic_us();
    const std::int64_t least_us = boot_us - after_us, most_us = boot_us - before_us;
    const bool has_slept = least_us >= kSuspendUsMin && asleep_us_ <= least_us - kSuspendUsMin;
    asleep_us_ = has_slept ? most_us : std::min(asleep_us_, most_us);
    return has_slept;
}

}  // namespace axg
