// SPDX-License-Identifier: Apache-2.0
// The enforced cap on the engine's side of a guard: bounds the speeds of a certificate, orders the
// cap of the next permit, and checks that the board obeys the caps that its samples acknowledge.
// Pure, from cycle to cycle; reserves no memory. Source: docs/reference/board.md, "The cap".
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

/// Longest time from an order to slow down until the samples acknowledge it, s.
[[nodiscard]] double cap_answer_seconds(const Machine& machine) noexcept;

/// Returns n: sample k - n was latched no later than the positions of sample k. 0: no age.
[[nodiscard]] std::uint32_t age_samples(const Machine& machine) noexcept;

class CapGuard {
  public:
    /// `machine` must outlive it.
    explicit CapGuard(const Machine& machine) noexcept : machine_(&machine) {}

    [[nodiscard]] bool is_on() const noexcept {
        return !is_ignored_ && machine_->guard.cap != CapPromise::none;
    }
    /// For a recorded board, which cannot obey present orders and named permits of another guard:
    /// every axis may run at rapid.
    void ignore() noexcept { is_ignored_ = true; }

    /// Records a snapshot, and the caps of the permit that it names. Call it for every snapshot.
    /// @param is_first  earlier snapshots no longer count
    /// @param error  largest error of a sample of each axis, mm or rad
    void note(const AxisSnapshot& snapshot, const CapFacts& facts, bool is_first,
              const std::array<double, kAxesMax>& error) noexcept;

    /// Call before the certificate's `prove`. Bounds the speed of each axis by the higher of two
    /// caps, the acknowledged one and the one ordered last. If a raise is due, the certificate
    /// tries the longer permit with the raised bounds. Same bounds for the same snapshots, until
    /// `judge`.
    void bound(StopCertificate& certificate) const noexcept;

    /// Call after the verdict on the proof with those bounds. Adds the cap that the permit orders,
    /// or a stop if the board broke its promise.
    /// @param wish  result of the search; null: no result
    void judge(const StopCycle& cycle, const CapWish* wish, bool is_armed,
               CycleResult& result) noexcept;

    /// Sets the order of the permit for the newest snapshot, from a dump that begins later.
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
    CapFact broken_;  // until the verdict of a cycle used it
};

}  // namespace axg
