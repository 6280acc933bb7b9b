// SPDX-License-Identifier: Apache-2.0
// Reads the guard's frames for the simulated motion board, which may move only while a valid permit
// is in force. The library for boards, firmware_if/board, reads them, as in firmware.
#pragma once

#include <array>
#include <cstdint>

#include "core/machine/configuration_hashes.hpp"
#include "core/machine/machine.hpp"
#include "firmware_if/board/axguard_board.h"
#include "firmware_if/protocol/axis_frames.hpp"

namespace axg {

inline constexpr std::int64_t kNever = INT64_MAX;
/// A cap for each bit of a permit's mask, 1/250 of rapid.
using CapGroups = std::array<std::uint8_t, AXG_BOARD_CAP_GROUPS>;

/// A permit for sample k is valid until t_k + n T on the board's own timer; t_k is the instant at
/// which the board latched sample k. The board ignores a pair that is late, lost or damaged, and
/// the last permit expires; the stop word and the stop frame end the motion at once.
class PermitWatch {
  public:
    /// @param is_jogging  the board reports a jog in its samples: only jog permits count; without
    ///     a jog they do not count
    /// @param permit_us  validity of a permit on the board's timer; 0: n T, as required
    /// @param hashes  of the board's machine, used if the layout has their ids
    /// @param cap  whether the board bounds all axes by the cap of the permits
    explicit PermitWatch(const CanLayout& layout, bool is_jogging = false,
                         std::int64_t permit_us = 0, const ConfigurationHashes& hashes = {},
                         CapPromise cap = CapPromise::none) noexcept;

    /// The board latched a sample and sends it under this SYNC counter.
    void on_latch(std::uint8_t sync_counter, std::int64_t latched_us) noexcept;
    /// The session frame that leaves with that sample. False: none is due.
    [[nodiscard]] bool take_session(std::int64_t now_us, CanFrame& out) noexcept;
    /// Flags of that sample, which name the permit whose cap the board obeys.
    [[nodiscard]] std::uint8_t ack_flags() const noexcept;
    /// The cap ordered for all axes, 1/250 of rapid.
    [[nodiscard]] std::uint8_t ordered_cap(std::int64_t now_us) noexcept;
    /// The same for each bit of the mask.
    [[nodiscard]] CapGroups ordered_caps(std::int64_t now_us) noexcept;
    [[nodiscard]] CapGroups keep_caps(const CapGroups& wanted, std::int64_t now_us) noexcept;
    /// Bounds all axes by `wanted` from now on; a lower bound than before must already be true.
    /// @return  the bound to obey
    [[nodiscard]] std::uint8_t keep_cap(std::uint8_t wanted, std::int64_t now_us) noexcept;
    /// The axes begin to move: from now on a permit that arrives after the end of the last one is
    /// too late.
    void begin(std::int64_t now_us) noexcept;
    /// The axes are at rest; repeated calls are allowed.
    void rest(std::int64_t now_us) noexcept;
    /// A person acknowledged a stop during standstill, and armed: discards all earlier permits and
    /// stops. No effect while the guard still sends stop.
    void acknowledge(std::int64_t now_us) noexcept;
    /// Processes a frame of the guard; call in order of arrival.
    void on_frame(const CanFrame& frame) noexcept;
    /// The board's own hash, once for each of the guard's. False: none is owed.
    [[nodiscard]] bool take_hash(std::int64_t now_us, CanFrame& out) noexcept;

    /// The first instant without a permit; INT64_MIN: there never was one.
    [[nodiscard]] std::int64_t valid_until_us() const noexcept { return valid_until_us_; }
    /// t_k of that permit's sample.
    [[nodiscard]] std::int64_t certified_us() const noexcept { return certified_us_; }
    /// When the guard ordered a stop; kNever: it has not.
    [[nodiscard]] std::int64_t stopped_us() const noexcept { return stopped_us_; }
    /// Advisory of that permit: 1/250 of rapid; 0 without one.
    [[nodiscard]] std::uint8_t speed_cap() const noexcept { return speed_cap_; }
    /// n of that permit; 0 without one.
    [[nodiscard]] std::uint8_t samples() const noexcept { return samples_; }
    /// Whether that permit has the word slow.
    [[nodiscard]] bool is_slow() const noexcept { return is_slow_; }
    [[nodiscard]] std::uint64_t permits() const noexcept { return permits_; }
    [[nodiscard]] std::uint64_t refused() const noexcept { return refused_; }
    /// State of the board's library, for tests that change its rules.
    [[nodiscard]] axg_board& library() noexcept { return board_; }

  private:
    static constexpr int kNothingOwed = -1;

    void power_up() noexcept;
    void arm(std::int64_t now_us) noexcept;
    void note_stop(std::int64_t now_us) noexcept;
    void note_permit(std::uint64_t now_us, std::uint8_t samples) noexcept;

    CanLayout layout_;
    ConfigurationHashes hashes_;
    CapPromise cap_;
    axg_board board_{};
    int owed_part_ = kNothingOwed;  // of the guard's last hash
    std::uint32_t nonce_ = 0;
    std::uint16_t lap_ = 0;
    std::uint8_t newest_sync_ = 0;
    std::int64_t last_stop_us_ = INT64_MIN;
    bool has_true_timer_;
    std::int64_t holds_us_;  // n T
    std::int64_t valid_until_us_ = INT64_MIN, certified_us_ = INT64_MIN, stopped_us_ = kNever;
    std::uint64_t permits_ = 0, refused_ = 0;
    std::uint8_t speed_cap_ = 0, samples_ = 0;
    bool is_moving_ = false, is_slow_ = false, is_jogging_;
};

}  // namespace axg
