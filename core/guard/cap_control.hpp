// SPDX-License-Identifier: Apache-2.0
// Chooses the cap that the next permit orders, and its axes: lowers it to the result of a search
// that fails for kCapPatience cycles, and raises it, in steps, only to a proven one. Pure, from
// cycle to cycle. No proof depends on it: every permit is sent for a proof with the caps that it
// orders. Source: docs/reference/board.md, "Which order".
#pragma once

#include <cstdint>

#include "core/guard/ack_ledger.hpp"

namespace axg {

inline constexpr std::uint8_t kCapCrawl = 1, kCapHold = 0;
inline constexpr std::uint8_t kMaskOfAll = 0xFF;
// Cycles in a row in which the search does not prove the order in force before a lower one is
// ordered. The noise of positions alone makes single searches fail. The lead is about 200 cycles.
inline constexpr std::uint32_t kCapPatience = 4;
inline constexpr std::int64_t kCapRoomUs = 100'000, kCapRaiseUs = 10'000, kCapHeldUs = 2'000'000;

struct CapOrder {
    std::uint8_t cap = kCapRapid;
    std::uint8_t mask = 0;  // bit i: it binds axis i; bit 7 binds axes 7 and up
};

/// Result of a search: what is proven a little later, if the axes go on as they do now.
struct CapWish {
    CapOrder best{};            // the proven order that costs least
    bool is_kept_fine = true;   // the last order is proven
    bool is_any_proven = true;  // else `best` is a crawl of all axes
};

struct CapCycle {
    std::int64_t sample_us = 0;  // instant of the sample
    CapWish wish{};
    bool is_proven = false;   // for a longer validity than the least
    bool is_slowing = false;  // the board acknowledges higher caps than the last order
    bool is_asked = false;    // this cycle tried the proof with `asked()`
    AxisCaps proven{};        // no axis' cap in the next permit may be higher
};

class CapControl {
  public:
    /// Whether the cycle of this sample should try the proof with `asked()`.
    [[nodiscard]] bool asks(std::int64_t sample_us) const noexcept;
    /// The order to try; it has a higher cap for some axis.
    [[nodiscard]] const CapOrder& asked() const noexcept { return asked_; }
    /// Returns the order of this cycle's permit. Precondition: samples in order of time; the order
    /// in force is within `proven`.
    CapOrder update(const CapCycle& cycle) noexcept;

    [[nodiscard]] const CapOrder& order() const noexcept { return order_; }
    /// Sets the order that another instance chose; this one only follows it.
    void set_order(const CapOrder& order) noexcept { order_ = order; }
    /// Whether a hold has lasted for so long that a person must be notified.
    [[nodiscard]] bool is_held(std::int64_t now_us) const noexcept {
        return order_.cap == kCapHold && now_us - held_since_us_ >= kCapHeldUs;
    }

  private:
    void fall(const CapCycle& cycle) noexcept;
    void crawl(const CapCycle& cycle) noexcept;
    void ask(const CapOrder& order, bool is_urgent) noexcept;
    [[nodiscard]] CapOrder next_raise(const CapCycle& cycle, bool had_asked) const noexcept;

    CapOrder order_{}, asked_{};
    bool has_asked_ = false, is_urgent_ = false, has_room_ = false;
    std::uint32_t unproven_ = 0, unkept_ = 0;  // cycles in a row; and of the search
    std::int64_t room_since_us_ = 0, asked_us_ = INT64_MIN, held_since_us_ = 0;
};

/// Whether no axis has a higher cap in the order than in `caps`.
[[nodiscard]] bool is_within(const CapOrder& order, const AxisCaps& caps) noexcept;
/// Returns an order that binds every axis of either order, by the lower cap.
[[nodiscard]] CapOrder lower_order(const CapOrder& a, const CapOrder& b) noexcept;

}  // namespace axg
