// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/trace_period.hpp"

#include <algorithm>
#include <array>

namespace axg {

std::uint32_t trace_period_us(TraceReader& trace, std::uint32_t sync_id) {
    constexpr std::size_t kGaps = 63;  // enough for a median that jitter and a loss do not move
    std::array<std::int64_t, kGaps> gaps{};
    std::size_t count = 0;
    std::int64_t last_us = 0;
    bool has_last = false;
    CanFrame frame;
    while (count < kGaps && trace.next(frame)) {
        if (frame.id != sync_id || frame.extended || frame.remote || frame.error || frame.fd) {
            continue;
        }
        if (has_last) {
            gaps[count++] = frame.time_us - last_us;
        }
        last_us = frame.time_us;
        has_last = true;
    }
    if (count < 2) {
        return 0;
    }
    const auto middle = gaps.begin() + static_cast<std::ptrdiff_t>(count / 2);
    std::nth_element(gaps.begin(), middle, gaps.begin() + static_cast<std::ptrdiff_t>(count));
    return static_cast<std::uint32_t>(std::clamp<std::int64_t>(*middle, 0, 1'000'000'000));
}

bool has_flexible_axes(TraceReader& trace, std::uint32_t axis_id) {
    CanFrame frame;
    for (int i = 0; i < 1000 && trace.next(frame); ++i) {
        if (frame.id == axis_id && !frame.extended && !frame.remote && !frame.error) {
            return frame.fd;
        }
    }
    return false;
}

}  // namespace axg
