// SPDX-License-Identifier: Apache-2.0
// Which lap each sample of the guard has on the board: the guard numbers laps by its own samples,
// and the board's session frames have to agree. The first one that does not reveals a bus that
// delays all frames by whole laps. Source: docs/reference/board.md, "Session".
#pragma once

#include <cstdint>

#include "firmware_if/protocol/axis_frames.hpp"
#include "firmware_if/protocol/permit_frames.hpp"

namespace axg {

enum class SessionStatus : std::uint8_t {
    begun,    // the first one, or one with another nonce: a person armed the board
    agrees,   // with the laps counted since
    held_up,  // another lap than counted: frames are old, or samples were lost by whole laps
};

class SessionWatch {
  public:
    /// A session frame, and the newest sample that the receiver numbered (its SYNC counter is
    /// sync_counter_of(sample)); the frame's sample is at most half a lap away from it.
    [[nodiscard]] SessionStatus on_session(const Session& session,
                                           std::uint64_t newest_sample) noexcept {
        constexpr std::int64_t kLap = kSyncCounterMax;
        const auto newest = static_cast<std::int64_t>(newest_sample);
        const std::int64_t ahead =
            (session.sync_counter - 1 - newest % kLap + kLap + kLap / 2) % kLap - kLap / 2;
        // One lap more, so that a sample before number 0 divides as the others.
        const std::int64_t counted = (newest + ahead + kLap) / kLap - 1;
        const auto offset = static_cast<std::uint16_t>(session.lap - counted);
        const bool is_new = !has_session_ || session.nonce != nonce_;
        const bool agrees = offset == offset_;
        if (is_new) {
            has_session_ = true;
            nonce_ = session.nonce;
            offset_ = offset;
            return SessionStatus::begun;
        }
        return agrees ? SessionStatus::agrees : SessionStatus::held_up;
    }

    [[nodiscard]] bool has_session() const noexcept { return has_session_; }
    /// Nonce and lap for a permit for this sample. Precondition: has_session().
    [[nodiscard]] std::uint32_t nonce() const noexcept { return nonce_; }
    [[nodiscard]] std::uint16_t lap_of(std::uint64_t sample) const noexcept {
        return static_cast<std::uint16_t>(sample / kSyncCounterMax + offset_);
    }

  private:
    bool has_session_ = false;
    std::uint32_t nonce_ = 0;
    std::uint16_t offset_ = 0;  // the board's lap less the receiver's
};

}  // namespace axg
