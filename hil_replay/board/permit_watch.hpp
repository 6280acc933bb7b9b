// SPDX-License-Identifier: Apache-2.0
// How a motion board reads the guard: it may move while the newest valid permit is in force, and no
// longer. Rules: docs/protocol.md, "From the guard".
#pragma once

#include <array>
#include <cstdint>

#include "firmware_if/protocol/axis_frames.hpp"
#include "firmware_if/protocol/guard_frames.hpp"

namespace axg {

inline constexpr std::int64_t kNever = INT64_MAX;

/// A permit for sample k holds until t_k + n T on the board's own timer; t_k is the instant at
/// which the board latched sample k. A pair that is late, lost or damaged is not used, and the last
/// one runs out by itself; the word for stop and the stop frame end the motion at once.
class PermitWatch {
  public:
    /// @param is_jogging  the board says so in its samples: their permits are for the jog, and for
    ///     nothing else; any other time such a permit is none
    /// @param permit_us  how long a permit holds on the board's timer; 0: n T, as it must
    explicit PermitWatch(const CanLayout& layout, bool is_jogging = false,
                         std::int64_t permit_us = 0) noexcept;

    /// The board latched a sample and sent it under this SYNC counter.
    void on_latch(std::uint8_t sync_counter, std::int64_t latched_us) noexcept {
        latched_us_[sync_counter] = latched_us;
    }
    /// From now on a permit that comes after the last one ran out is too late.
    void begin() noexcept { is_moving_ = true; }
    /// A frame of the guard, in order of arrival.
    void on_frame(const CanFrame& frame) noexcept;

    /// The first instant without a permit; INT64_MIN: there never was one.
    [[nodiscard]] std::int64_t valid_until_us() const noexcept { return valid_until_us_; }
    /// t_k of the sample that it stands on.
    [[nodiscard]] std::int64_t certified_us() const noexcept { return certified_us_; }
    /// When the guard asked for a stop; kNever: it has not.
    [[nodiscard]] std::int64_t stopped_us() const noexcept { return stopped_us_; }
    /// Advisory of that permit: 1/250 of rapid; 0 without one.
    [[nodiscard]] std::uint8_t speed_cap() const noexcept { return speed_cap_; }
    /// Whether that permit says slow.
    [[nodiscard]] bool is_slow() const noexcept { return is_slow_; }
    [[nodiscard]] std::uint64_t permits() const noexcept { return permits_; }
    [[nodiscard]] std::uint64_t refused() const noexcept { return refused_; }

  private:
    void on_permit(const Permit& permit, std::int64_t now_us) noexcept;

    CanLayout layout_;
    PermitChecker checker_;
    std::int64_t holds_us_;  // n T
    std::array<std::int64_t, kSyncCounterMax + 1> latched_us_;
    std::int64_t valid_until_us_ = INT64_MIN, certified_us_ = INT64_MIN, stopped_us_ = kNever;
    std::uint64_t permits_ = 0, refused_ = 0;
    std::uint8_t speed_cap_ = 0;
    bool is_moving_ = false, is_slow_ = false, is_jogging_;
};

}  // namespace axg
