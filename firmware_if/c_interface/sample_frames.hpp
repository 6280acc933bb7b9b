// SPDX-License-Identifier: Apache-2.0
// A sample of the host process as the frames that a board would send of it: the guard has one path
// for both, and a recording of the frames is a recording of the guard.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "firmware_if/axguard.h"
#include "firmware_if/protocol/axis_frames.hpp"

namespace axg {

/// Formats whose frames carry all that an axg_sample has.
[[nodiscard]] bool takes_samples(const Machine& machine) noexcept;

class SampleFrames {
  public:
    explicit SampleFrames(const Machine& machine) noexcept;

    /// SYNC first, then positions, heartbeat and session where they are due. Empty: not a sample of
    /// this machine. SYNC has the stamp of the sample, the others arrive now.
    [[nodiscard]] std::span<const CanFrame> encode(const axg_sample& sample,
                                                   std::int64_t now_us) noexcept;

  private:
    void put_session(const axg_sample& sample, std::uint32_t& count) noexcept;

    AxisEncoder encoder_;
    bool takes_samples_;
    std::uint16_t tool_max_;  // that the frames can carry
    std::array<CanFrame, kFramesPerSnapshotMax> frames_{};
    bool has_session_ = false;
    std::uint32_t nonce_ = 0;  // of the last session frame, as the two below
    std::uint16_t lap_ = 0;
    std::int64_t session_us_ = 0;
    std::uint8_t session_counter_ = 0;
};

}  // namespace axg
