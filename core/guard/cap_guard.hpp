// SPDX-License-Identifier: Apache-2.0
// The enforced cap on the engine's side of a guard: which speeds a certificate may take for
// granted, which cap the next permit orders, and whether the board keeps what its samples
// acknowledge. Pure, from cycle to cycle, nothing is reserved. Source: docs/reference/board.md,
// "The cap".
#pragma once

#include <array>
#include <cstdint>

#include "core/base/limits.hpp"
#include "core/certificate/stop_certificate.hpp"
#include "core/guard/ack_ledger.hpp"
#include "core/guard/cap_control.hpp"
#include "core/guard/monitor.hpp"
#include "core/machine/axis_snapshot.hpp"
#include "core/machine/machine.hpp"

namespace axg {

/// From an order to slow down until the samples acknowledge it, s, at the latest.
[[nodiscard]] double cap_answer_seconds(const Machine& machine) noexcept;

/// A sample so many before was latched no later than the positions of one; 0: they have no age.
[[nodiscard]] std::uint32_t age_samples(const Machine& machine) noexcept;

class CapGuard {
  public:
    /// `machine` must outlive it.
    explicit CapGuard(const Machine& machine) noexcept : machine_(&machine) {}

    [[nodiscard]] bool is_on() const noexcept {
        return !is_ignored_ && machine_->guard.cap != CapPromise::none;
    }
    /// A recorded board cannot keep what is ordered now, and named permits of another guard: every
    /// axis may run at rapid.
    void ignore() noexcept { is_ignored_ = true; }

    /// Every snapshot, and what is known of the permit that it names.
    /// @param is_first  nothing before it counts
    /// @param error  of each axis, mm or rad: how far a sample may be off
    void note(const AxisSnapshot& snapshot, const CapFacts& facts, bool is_first,
              const std::array<double, kAxesMax>& error) noexcept;

    /// Before the certificate's `prove`: no axis is faster than the higher one of what the board
    /// acknowledges and what the permit for this sample will order. Where a raise is due, the
    /// longer permit is asked about with that. The same for the same snapshots, until `judge`.
    void bound(StopCertificate& certificate) const noexcept;

    /// After the judgement of what was proven with those bounds: the cap that the permit orders, or
    /// a stop where the board does not keep its promise.
    /// @param wish  what is proven a little later; null: nothing is known
    void judge(const StopCycle& cycle, const CapWish* wish, bool is_armed,
               CycleResult& result) noexcept;

    /// What the permit for the newest snapshot ordered, where a dump that begins later says so.
    void set_order(const CapOrder& order) noexcept;
    [[nodiscard]] const CapOrder& order() const noexcept { return control_.order(); }

  private:
    struct Seen {
        std::uint64_t sample = 0;
        std::array<double, kAxesMax> position{};
    };
    [[nodiscard]] AxisCaps bound_caps(const CapOrder& order) const noexcept;
    [[nodiscard]] bool is_above() const noexcept;
    [[nodiscard]] bool asks_raise() const noexcept;
    void note_fall(const CapOrder& before) noexcept;
    void order_next(const StopCycle& cycle, const CapWish* wish) noexcept;
    [[nodiscard]] bool is_too_fast(std::uint32_t axis, const Seen& before) const noexcept;
    void watch_speeds() noexcept;
    void watch_answer() noexcept;

    static constexpr std::uint32_t kSeen = 17;  // 16 periods from the first to the last

    const Machine* machine_;
    CapControl control_;
    CapFacts facts_;
    std::int64_t latched_us_ = 0, fell_us_ = 0;  // newest sample, and last order to slow down
    std::array<Seen, kSeen> seen_{};
    std::uint64_t seen_count_ = 0;
    std::array<double, kAxesMax> error_{};
    bool is_ignored_ = false;
    CapFact broken_;  // until a cycle was judged by it
};

}  // namespace axg
