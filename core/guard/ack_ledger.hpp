// SPDX-License-Identifier: Apache-2.0
// The caps that may be in force on a board that names a permit by the low four bits of its number.
// Every sixteenth permit has the same bits, and a board names an old permit until it has slowed
// down: the ledger uses the highest caps of all permits that the bits may mean.
// Source: docs/reference/board.md, "The cap".
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "core/base/limits.hpp"
#include "core/guard/advisories.hpp"

namespace axg {

/// A bound for the speed of each axis, 1/250 of its largest.
using AxisCaps = std::array<std::uint8_t, kAxesMax>;
inline constexpr std::uint8_t kCapRapid{kSpeedCapRapid};

[[nodiscard]] constexpr AxisCaps rapid_caps() noexcept {
    AxisCaps caps{};
    caps.fill(kCapRapid);
    return caps;
}
/// Returns the cap of each axis by a permit's cap and mask; bit 7 is for axes 7 and up.
[[nodiscard]] AxisCaps caps_of_permit(std::uint8_t cap, std::uint8_t mask) noexcept;
/// Returns the higher cap of each axis.
[[nodiscard]] AxisCaps higher_caps(const AxisCaps& a, const AxisCaps& b) noexcept;

enum class AckStatus : std::uint8_t {
    unknown = 0,  // no permit since the one that was named last has this number: a fault
    none,         // the sample names no permit
    known,
};
/// With an `unknown` ack or none, every axis may run at rapid.
struct AckedCaps {
    AckStatus status = AckStatus::none;
    AxisCaps caps = rapid_caps();
};

/// Upper bounds of the caps in force on the board, by one sample.
struct CapFacts {
    AckStatus status = AckStatus::none;
    // The highest since the instant of the sample's positions. Without an age: of the permit that
    // the sample names. With an age: of every permit from the one on that an earlier sample named.
    AxisCaps acked = rapid_caps();
    // The highest since the instant of the positions 16 samples before. After a sample that names
    // no permit, every axis may run at rapid.
    AxisCaps since = rapid_caps();
};

/// Largest age of positions, in samples: with older positions every axis may run at rapid.
inline constexpr std::uint32_t kAgeSamplesMax = 16;

class AckLedger {
  public:
    /// Begins a new session: the board no longer names earlier permits.
    void clear() noexcept { *this = AckLedger(); }
    /// Records a sent permit. Discards all earlier permits if its number is not one more than that
    /// of the last one.
    void note_sent(std::uint8_t live_counter, const AxisCaps& caps) noexcept;
    /// Records the permit that a sample names. Permits sent after its latch do not lower the bound.
    /// Precondition: `nibble` is below 16.
    [[nodiscard]] AckedCaps note_ack(std::optional<std::uint8_t> nibble) noexcept;
    /// The same for a board that names a permit for one of its last 16 samples or none, with at
    /// most one permit a sample: the bits then identify the permit.
    /// @param lost  samples lost before this one: the permit may be older by that many
    [[nodiscard]] AckedCaps note_recent_ack(std::optional<std::uint8_t> nibble,
                                            std::uint64_t lost = 0) noexcept;
    /// Records one sample of a board that first names such a permit, and may go on naming it for as
    /// long as it slows down. Call once a sample; the result covers the 16 samples before it too.
    /// Source: docs/reference/board.md, rule (i).
    /// @param age_samples  the sample that many before was latched no later than these positions
    [[nodiscard]] CapFacts note_sample(std::optional<std::uint8_t> nibble, std::uint64_t lost = 0,
                                       std::uint32_t age_samples = 0) noexcept;

    /// Number of permits sent after the oldest one that the last ack may mean.
    [[nodiscard]] std::uint64_t behind() const noexcept { return newest_ - oldest_; }

  private:
    static constexpr std::uint64_t kNibbles = 16, kKept = 256, kSamples = 17;

    [[nodiscard]] AxisCaps highest_from(std::uint64_t number) const noexcept;
    [[nodiscard]] AxisCaps highest_in(std::uint64_t samples) const noexcept;

    std::array<AxisCaps, kKept> kept_{};          // the newest permits, by their number
    std::array<AxisCaps, kNibbles> forgotten_{};  // the highest caps of those before, by nibble
    std::array<std::uint64_t, kNibbles> forgotten_last_{};  // the newest of each
    // Numbers from kKept on, so that they agree with the live counter; 0: none was sent.
    std::uint64_t newest_ = 0, first_ = 0;
    std::uint64_t oldest_ = 0;  // permit that the last ack may mean
    // `oldest_` at each of the last samples; 0: none.
    std::array<std::uint64_t, kSamples + kAgeSamplesMax> named_{};
    std::uint64_t samples_ = 0;
    std::optional<std::uint8_t> last_{};  // nibble of the last sample
};

}  // namespace axg
