// SPDX-License-Identifier: Apache-2.0
// The session frames that a board would send, for a trace of one that sends none: a guard permits
// nothing without them.
#pragma once

#include <cstdint>
#include <optional>

#include "core/machine/can_layout.hpp"
#include "firmware_if/can/can_frame.hpp"

namespace axg {

class AddedSession {
  public:
    /// Precondition: has_sample_counter(can).
    explicit AddedSession(const CanLayout& can) noexcept
        : sync_id_(can.sync_id), session_id_(can.session_in_id) {}

    /// The session frame behind a SYNC; empty behind any other frame. Each has a nonce of its own,
    /// as if a person had armed the board: the guard then compares no laps, which a damaged trace
    /// may hide.
    [[nodiscard]] std::optional<CanFrame> behind(const CanFrame& frame) noexcept;

  private:
    std::uint32_t sync_id_, session_id_, sent_ = 0;
};

}  // namespace axg
