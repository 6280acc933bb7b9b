// SPDX-License-Identifier: Apache-2.0
// Which lap each sample of the guard has on the board: the guard numbers laps by its own samples,
// and the board's session frames have to agree. The first one that does not reveals a bus that
// delays all frames by whole laps. Source: docs/reference/board.md, "Session".
#pragma once

#include <cstdint>
#include <optional>

#include "firmware_if/protocol/axis_frames.hpp"
#include "firmware_if/protocol/permit_frames.hpp"
#include "firmware_if/receiver/frame_gate.hpp"
#include "firmware_if/receiver/received_samples.hpp"

namespace axg {

// A board sends its session every 100 ms: two lost in a row are tolerated.
inline constexpr std::int64_t kSessionTimeoutUs = 300'000;

/// The CRC of a permit covers these: the board's nonce, and the lap of the sample.
struct SampleSession {
    std::uint32_t nonce = 0;
    std::uint16_t lap = 0;

    friend constexpr bool operator==(const SampleSession&, const SampleSession&) = default;
};

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

/// The sessions of a receiver, and its samples as they count them.
struct SessionLaps {
    LastFrame frame;
    SessionWatch watch;
    std::int64_t time_us = 0;  // of the last session frame that agreed
    std::uint64_t newest = 0;  // counts as SYNC does: its counter is that of the last sample

    /// Numbers the sample after `last` by its counter, across lost samples too; the next session
    /// frame reveals whole laps that were lost.
    void number(std::uint8_t sync_counter, const LastSample& last) noexcept {
        // One lap more at first, so that a sample of the lap before has a number too.
        newest = last.is_known ? newest + before(last.sync_counter, sync_counter)
                               : kSyncCounterMax + sync_counter - 1U;
    }
    /// Without a sample there are no laps to number: the next frame comes in 100 ms.
    [[nodiscard]] ReceiverFault on_session(const CanFrame& received, const Session& session,
                                           const ReceivedSamples& samples) noexcept {
        const ReceiverFault wrong = frame.judge(received, session.counter);
        if (wrong != ReceiverFault::none || !samples.last.is_known) {
            return wrong;
        }
        if (watch.on_session(session, newest) == SessionStatus::held_up) {
            return ReceiverFault::held_up;
        }
        time_us = samples.now_us;
        return ReceiverFault::none;
    }
    [[nodiscard]] std::optional<SampleSession> of(std::uint8_t sync_counter,
                                                  const ReceivedSamples& samples) const noexcept {
        const bool is_counter = sync_counter >= 1 && sync_counter <= kSyncCounterMax;
        if (!is_counter || !samples.last.is_known || !watch.has_session() ||
            samples.now_us - time_us > kSessionTimeoutUs) {
            return std::nullopt;
        }
        const std::uint64_t sample = newest - before(sync_counter, samples.last.sync_counter);
        return SampleSession{.nonce = watch.nonce(), .lap = watch.lap_of(sample)};
    }
    void forget() noexcept {
        frame.sequence.reset();
        watch = {};
    }

  private:
    /// Samples from one counter to the next occurrence of another.
    [[nodiscard]] static std::uint32_t before(std::uint8_t from, std::uint8_t to) noexcept {
        return (to + std::uint32_t{kSyncCounterMax} - from) % kSyncCounterMax;
    }
};

}  // namespace axg
