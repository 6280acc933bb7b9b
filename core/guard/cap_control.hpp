// SPDX-License-Identifier: Apache-2.0
// Which cap the next permit orders, and of which axes: down at once to what a search found, and up
// only by what is proven. Pure, from cycle to cycle. It enters no proof: whatever it orders, a
// permit is sent for what was proven with those caps. Source: docs/reference/board.md, "Which
// order".
#pragma once

#include <cstdint>

#include "core/guard/ack_ledger.hpp"

namespace axg {

inline constexpr std::uint8_t kCapCrawl = 1, kCapHold = 0;
inline constexpr std::uint8_t kMaskOfAll = 0xFF;
inline constexpr std::int64_t kCapRoomUs = 100'000, kCapRaiseUs = 10'000, kCapHeldUs = 2'000'000;

struct CapOrder {
    std::uint8_t cap = kCapRapid;
    std::uint8_t mask = 0;  // bit i: it binds axis i; bit 7 binds axes 7 and up
};

/// What a search found a little later, if the axes go on as they do now.
struct CapWish {
    CapOrder best{};            // of what is proven, the one that costs least
    bool is_kept_fine = true;   // what was ordered last is proven
    bool is_any_proven = true;  // else `best` is a crawl of all axes
};

struct CapCycle {
    std::int64_t sample_us = 0;  // instant of the sample
    CapWish wish{};
    bool is_proven = false;   // for a longer validity than the least
    bool is_slowing = false;  // the board acknowledges higher caps than were ordered last
    bool is_asked = false;    // the proof was asked about `asked()`, in this very cycle
    AxisCaps proven{};        // no axis' cap in the next permit may be higher
};

class CapControl {
  public:
    /// Whether the cycle of this sample should ask the proof about `asked()`.
    [[nodiscard]] bool asks(std::int64_t sample_us) const noexcept;
    /// An order that has a higher cap for some axis.
    [[nodiscard]] const CapOrder& asked() const noexcept { return asked_; }
    /// What the permit of this cycle orders. Precondition: samples in order of time; the order in
    /// force is within `proven`.
    CapOrder update(const CapCycle& cycle) noexcept;

    [[nodiscard]] const CapOrder& order() const noexcept { return order_; }
    /// As another one has it, which this one only follows.
    void set_order(const CapOrder& order) noexcept { order_ = order; }
    /// Held where it stands for so long that a person has to be told.
    [[nodiscard]] bool is_held(std::int64_t now_us) const noexcept {
        return order_.cap == kCapHold && now_us - held_since_us_ >= kCapHeldUs;
    }

  private:
    void fall(const CapCycle& cycle) noexcept;
    void crawl(const CapCycle& cycle) noexcept;
    void ask(const CapOrder& order, bool is_urgent) noexcept;

    CapOrder order_{}, asked_{};
    bool has_asked_ = false, is_urgent_ = false, has_room_ = false;
    std::uint32_t unproven_ = 0;  // cycles in a row
    std::int64_t room_since_us_ = 0, asked_us_ = INT64_MIN, held_since_us_ = 0;
};

/// No axis has a higher cap.
[[nodiscard]] bool is_within(const CapOrder& order, const AxisCaps& caps) noexcept;
/// What binds every axis that one of the two binds, by the lower cap.
[[nodiscard]] CapOrder lower_order(const CapOrder& a, const CapOrder& b) noexcept;

}  // namespace axg
