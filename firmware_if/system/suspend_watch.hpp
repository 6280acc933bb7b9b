// SPDX-License-Identifier: Apache-2.0
// Whether the computer was suspended: CLOCK_BOOTTIME counts that time, CLOCK_MONOTONIC does not, so
// the guard's own clock cannot see it. Reading both needs two calls; a thread that was held between
// them must not look like a suspend.
#pragma once

#include <cstdint>

namespace axg {

/// Microseconds; a test scripts them.
struct SuspendClocks {
    std::int64_t (*monotonic_us)() noexcept;
    std::int64_t (*boottime_us)() noexcept;
};
[[nodiscard]] SuspendClocks system_suspend_clocks() noexcept;

class SuspendWatch {
  public:
    explicit SuspendWatch(const SuspendClocks& clocks = system_suspend_clocks()) noexcept;
    /// Since the last call: reported once for each suspend of kSuspendUsMin or longer.
    [[nodiscard]] bool has_slept() noexcept;

    static constexpr std::int64_t kSuspendUsMin = 1000;

  private:
    SuspendClocks clocks_;
    std::int64_t asleep_us_ = INT64_MAX;  // since the start of the system, at most
};

}  // namespace axg
