// SPDX-License-Identifier: Apache-2.0
// How the simulated motion board reads the guard: it may move while a valid permit is in force, and
// no longer. Permits of version 2 are read by the library for boards, firmware_if/board, as
// firmware would; those of version 1 by the rules of docs/reference/protocol.md, "From the guard".
#pragma once

#include <array>
#include <cstdint>

#include "core/machine/configuration_hashes.hpp"
#include "core/machine/machine.hpp"
#include "firmware_if/board/axguard_board.h"
#include "firmware_if/protocol/axis_frames.hpp"
#include "firmware_if/protocol/guard_frames.hpp"

namespace axg {

inline constexpr std::int64_t kNever = INT64_MAX;
/// A cap for each bit of a permit's mask, 1/250 of rapid.
using CapGroups = std::array<std::uint8_t, AXG_BOARD_CAP_GROUPS>;

/// A permit for sample k holds until t_k + n T on the board's own timer; t_k is the instant at
/// which the board latched sample k. A pair that is late, lost or damaged is not used, and the last
/// one runs out by itself; the word for stop and the stop frame end the motion at once.
class PermitWatch {
  public:
    /// @param is_jogging  the board says so in its samples: their permits are for the jog, and for
    ///     nothing else; any other time such a permit is none
    /// @param permit_us  how long a permit holds on the board's timer; 0: n T, as it must
    /// @param hashes  of the machine that the board was given, where the layout has their ids
    /// @param cap  version 2: whether it keeps all axes within the cap of the permits
    explicit PermitWatch(const CanLayout& layout, bool is_jogging = false,
                         std::int64_t permit_us = 0, const ConfigurationHashes& hashes = {},
                         CapPromise cap = CapPromise::none) noexcept;

    /// The board latched a sample and sends it under this SYNC counter.
    void on_latch(std::uint8_t sync_counter, std::int64_t latched_us) noexcept;
    /// Version 2: the session frame that leaves with that sample. False: none is due.
    [[nodiscard]] bool take_session(std::int64_t now_us, CanFrame& out) noexcept;
    /// Version 2: what the flags of that sample say of the permit whose cap the board keeps.
    [[nodiscard]] std::uint8_t ack_flags() const noexcept;
    /// Version 2: the cap that all axes are to come to, 1/250 of rapid.
    [[nodiscard]] std::uint8_t ordered_cap(std::int64_t now_us) noexcept;
    /// The same for each bit of the mask.
    [[nodiscard]] CapGroups ordered_caps(std::int64_t now_us) noexcept;
    [[nodiscard]] CapGroups keep_caps(const CapGroups& wanted, std::int64_t now_us) noexcept;
    /// The board keeps all axes below this from now on; a lower one must be true already.
    /// @return  what it may have
    [[nodiscard]] std::uint8_t keep_cap(std::uint8_t wanted, std::int64_t now_us) noexcept;
    /// The axes begin to move: from now on a permit that comes after the last one ran out is too
    /// late.
    void begin(std::int64_t now_us) noexcept;
    /// They rest. May be reported again.
    void rest(std::int64_t now_us) noexcept;
    /// A person looked at a stop that came while nothing moved, and armed: what came before counts
    /// no more. Version 2: not while the guard still sends stop.
    void acknowledge(std::int64_t now_us) noexcept;
    /// A frame of the guard, in order of arrival.
    void on_frame(const CanFrame& frame) noexcept;
    /// The board's own hash, once for each of the guard's. False: none is owed.
    [[nodiscard]] bool take_hash(std::int64_t now_us, CanFrame& out) noexcept;

    /// The first instant without a permit; INT64_MIN: there never was one.
    [[nodiscard]] std::int64_t valid_until_us() const noexcept { return valid_until_us_; }
    /// t_k of that permit's sample.
    [[nodiscard]] std::int64_t certified_us() const noexcept { return certified_us_; }
    /// When the guard asked for a stop; kNever: it has not.
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

    void on_permit(const Permit& permit, std::int64_t now_us) noexcept;
    void power_up() noexcept;
    void arm(std::int64_t now_us) noexcept;
    void hear(const CanFrame& frame) noexcept;
    void note_stop(std::int64_t now_us) noexcept;
    void note_permit(std::uint64_t now_us, std::uint8_t samples) noexcept;

    CanLayout layout_;
    ConfigurationHashes hashes_;
    CapPromise cap_;
    PermitChecker checker_;         // of version 1
    axg_board board_{};             // of version 2, and of hashes
    int owed_part_ = kNothingOwed;  // of the guard's last hash
    std::uint32_t nonce_ = 0;
    std::uint16_t lap_ = 0;
    std::uint8_t newest_sync_ = 0;
    std::int64_t last_stop_us_ = INT64_MIN;
    bool has_true_timer_;
    std::int64_t holds_us_;  // n T
    std::array<std::int64_t, kSyncCounterMax + 1> latched_us_;
    std::int64_t valid_until_us_ = INT64_MIN, certified_us_ = INT64_MIN, stopped_us_ = kNever;
    std::uint64_t permits_ = 0, refused_ = 0;
    std::uint8_t speed_cap_ = 0, samples_ = 0;
    bool is_moving_ = false, is_slow_ = false, is_jogging_;
};

}  // namespace axg
