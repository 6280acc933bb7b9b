// SPDX-License-Identifier: Apache-2.0
// Which cap the next permit orders: down at once, up in small steps and only by what is proven, a
// crawl, and hold. Pure, from cycle to cycle. It enters no proof: whatever it orders, a permit is
// sent for what was proven with that cap. Source: docs/reference/board.md, "The cap".
#pragma once

#include <cstdint>

#include "core/guard/ack_ledger.hpp"
#include "core/machine/machine.hpp"

namespace axg {

inline constexpr std::uint8_t kCapCrawl = 1, kCapHold = 0;
inline constexpr std::uint8_t kMaskOfAll = 0xFF;
inline constexpr std::int64_t kCapRoomUs = 100'000, kCapRaiseUs = 10'000, kCapHeldUs = 2'000'000;

/// What a cycle found out, at the caps that the board acknowledges and those ordered last.
struct CapCycle {
    std::int64_t sample_us = 0;    // instant of the sample
    std::uint8_t wanted = 0;       // the fastest cap that is proven a little later, 0: none
    bool is_proven = false;        // for the longest validity that the control steers for
    bool is_raise_proven = false;  // the same with `raised_cap`, in this very cycle
    bool is_raise_asked = false;   // whether it is; the next time is a while later
};

struct CapOrder {
    std::uint8_t cap = kCapRapid;
    std::uint8_t mask = 0;  // bit i: it binds axis i; bit 7 binds axes 7 and up
};

class CapControl {
  public:
    explicit CapControl(CapPromise promise) noexcept : promise_(promise) {}

    /// The cap that a raise would order: what the cycle asks the proof about, besides what is in
    /// force. That of the last order: no raise is due.
    [[nodiscard]] std::uint8_t raised_cap() const noexcept;
    /// Whether the cycle of this sample should ask about it.
    [[nodiscard]] bool asks_raise(std::int64_t sample_us) const noexcept;
    /// What the permit of this cycle orders. Precondition: samples in order of time.
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
    void rise(const CapCycle& cycle) noexcept;
    [[nodiscard]] bool has_room(std::uint8_t wanted) const noexcept;

    CapPromise promise_;
    CapOrder order_;
    bool has_room_ = false;
    std::int64_t room_since_us_ = 0, raised_us_ = INT64_MIN, held_since_us_ = 0;
    std::int64_t asked_us_ = INT64_MIN;
};

}  // namespace axg
