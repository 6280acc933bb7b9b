// SPDX-License-Identifier: Apache-2.0
// Whether a frame of the board may be used, before anybody reads its positions: sequence of
// counters, number of frames in a period, heartbeat. Pure. Claim: each fault has its test
// (tests/unit/firmware_if/receiver/README.md).
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include "firmware_if/can/can_frame.hpp"
#include "firmware_if/protocol/e2e.hpp"
#include "firmware_if/receiver/receiver_faults.hpp"

namespace axg {

/// The last frame of one id that was used.
struct LastFrame {
    SequenceCheck sequence;
    std::array<std::uint8_t, 64> payload{};

    /// The fault of a second frame with the counter, or the SYNC, of the last one.
    [[nodiscard]] ReceiverFault repeat_of(const CanFrame& frame) const noexcept {
        const auto* end = frame.data.data() + frame.length_bytes;
        const bool is_same = std::equal(frame.data.data(), end, payload.data());
        return is_same ? ReceiverFault::repeated : ReceiverFault::spoofed;
    }
    /// none: the frame may be used, and is the last one.
    [[nodiscard]] ReceiverFault judge(const CanFrame& frame, std::uint8_t counter) noexcept {
        if (sequence.is_repeat(counter)) {
            return repeat_of(frame);
        }
        if (sequence.next(counter) == Sequence::wrong) {
            return ReceiverFault::wrong_sequence;
        }
        payload = frame.data;
        return ReceiverFault::none;
    }
};

/// More than twice a set of our frames in one period: another node sends them too. The period
/// starts anew with each SYNC, or by itself without SYNC.
struct FloodWindow {
    std::int64_t period_us = 0;
    std::uint32_t set_frames = 0;
    std::int64_t begin_us = INT64_MIN;
    std::uint32_t frames = 0;

    void begin(std::int64_t now_us) noexcept {
        begin_us = now_us;
        frames = 0;
    }
    [[nodiscard]] bool is_flood(std::int64_t now_us) noexcept {
        if (begin_us == INT64_MIN || now_us - begin_us >= period_us) {
            begin(now_us);
        }
        return ++frames > 2 * set_frames;
    }
};

struct HeartbeatWatch {
    bool is_awaited = false;  // the format has one
    std::int64_t timeout_us = 0;
    bool is_operational = false;  // by the last one
    std::int64_t time_us = 0;

    [[nodiscard]] bool is_fresh(std::int64_t now_us) const noexcept {
        return !is_awaited || (is_operational && now_us - time_us <= timeout_us);
    }
};

/// SYNC and heartbeat: classical, with no other length than this.
[[nodiscard]] inline ReceiverFault shape_of(const CanFrame& frame, std::uint8_t bytes) noexcept {
    if (frame.fd) {
        return ReceiverFault::bad_format;
    }
    if (frame.raw_dlc != 0) {
        return ReceiverFault::raw_dlc;
    }
    return frame.length_bytes == bytes ? ReceiverFault::none : ReceiverFault::bad_length;
}

}  // namespace axg
