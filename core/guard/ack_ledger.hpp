// SPDX-License-Identifier: Apache-2.0
// Which caps a board may be keeping that names a permit by the low four bits of its number. The
// same bits come again with every sixteenth permit, and a board that slows down names an old permit
// for as long as that takes: so of all permits that the bits may mean the highest caps count.
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
/// What the cap and the mask of a permit say of each axis; bit 7 is for axes 7 and up.
[[nodiscard]] AxisCaps caps_of_permit(std::uint8_t cap, std::uint8_t mask) noexcept;
/// Of each axis the higher one.
[[nodiscard]] AxisCaps higher_caps(const AxisCaps& a, const AxisCaps& b) noexcept;

enum class AckStatus : std::uint8_t {
    unknown = 0,  // no permit since the one that was named last has this number: a fault
    none,         // the sample names no permit
    known,
};
/// Of an ack that is not known, every axis may run at rapid.
struct AckedCaps {
    AckStatus status = AckStatus::none;
    AxisCaps caps = rapid_caps();
};

/// What is known with a sample of the caps that its board keeps.
struct CapFacts {
    AckStatus status = AckStatus::none;
    // The highest that it can have kept since the instant of its positions. Where they have no age
    // that is what the sample names, else every permit from the one named by a sample before it on.
    AxisCaps acked = rapid_caps();
    // And since the instant of positions 16 samples before. A sample that names none lets every
    // axis run at rapid.
    AxisCaps since = rapid_caps();
};

/// Positions that were latched earlier than so many samples before: every axis may run at rapid.
inline constexpr std::uint32_t kAgeSamplesMax = 16;

class AckLedger {
  public:
    /// A new session: no permit of before is ever named.
    void clear() noexcept { *this = AckLedger(); }
    /// A permit is sent. Its number is one more than that of the last one, or nothing of before is
    /// known.
    void note_sent(std::uint8_t live_counter, const AxisCaps& caps) noexcept;
    /// A sample names a permit. Permits that were sent after its latch do not make the bound lower.
    /// Precondition: below 16.
    [[nodiscard]] AckedCaps note_ack(std::optional<std::uint8_t> nibble) noexcept;
    /// The same of a board that names a permit for one of its last 16 samples or none, with one
    /// permit a sample at most: what the bits mean is then known.
    /// @param lost  samples before this one that were not heard: it may be older by so many
    [[nodiscard]] AckedCaps note_recent_ack(std::optional<std::uint8_t> nibble,
                                            std::uint64_t lost = 0) noexcept;
    /// Once a sample, of a board that names such a permit first, and may go on naming it however
    /// long it slows down; with what follows from the 16 samples before it. Source:
    /// docs/reference/board.md, rule (i).
    /// @param age_samples  a sample so many before was latched no later than these positions
    [[nodiscard]] CapFacts note_sample(std::optional<std::uint8_t> nibble, std::uint64_t lost = 0,
                                       std::uint32_t age_samples = 0) noexcept;

    /// So many permits were sent after the oldest one that the last ack may mean.
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
    std::uint64_t oldest_ = 0;  // that the last ack may mean
    // The same of the last samples; 0: none.
    std::array<std::uint64_t, kSamples + kAgeSamplesMax> named_{};
    std::uint64_t samples_ = 0;
    std::optional<std::uint8_t> last_{};  // what the last sample named
};

}  // namespace axg
