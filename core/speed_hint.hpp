// SPDX-License-Identifier: Apache-2.0
// The speed cap of a cycle: the fastest feed, any way, that a certificate would still cover where
// the axes are now. Asked after the certificate, with what that has left of the cycle's questions:
// two a pair at most. Advice: it enters no proof. mm and s, or rad and s.
// Source: docs/stoppable.md, "The speed cap".
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "core/arena.hpp"
#include "core/engine.hpp"
#include "core/joint_path.hpp"
#include "core/machine.hpp"
#include "core/speed_cap.hpp"
#include "core/stop_plan.hpp"

namespace axg {

/// From the sample that a cap is computed of until the axes obey it, s: what the machine file says,
/// and half of the time in which the softest axis turns its acceleration round.
[[nodiscard]] double cap_lead_seconds(const Machine& machine) noexcept;

/// Where the axes can get, were each to run at up to `share` of its largest speed, either way, for
/// as long as a cap takes to be obeyed, and then as the certificate allows for. About the newest
/// picture. Precondition: the plan noted one.
[[nodiscard]] JointBox capped_reach(const Machine& machine, const StopPlan& plan,
                                    double share) noexcept;

class SpeedHint {
  public:
    /// `machine` must outlive it. Empty: memory ran out.
    [[nodiscard]] static std::optional<SpeedHint> create(const Machine& machine);

    /// The cap at the position of the plan's last `prove`, of the pairs that were asked about; from
    /// one call to the next it rises to little more than twice its value, and falls at once.
    /// Cost: two questions a pair, in two batches, and eight boxes a pair without a question. Where
    /// the certificate has left fewer nothing is asked, and the cap is 0.
    void advise(const Engine& engine, const StopPlan& plan) noexcept;

    /// 1/250 of rapid; 0: no feed is proven, or nothing is known.
    [[nodiscard]] std::uint8_t cap() const noexcept { return cap_; }
    [[nodiscard]] std::uint32_t questions() const noexcept { return questions_count_; }

    [[nodiscard]] std::size_t memory_bytes() const noexcept { return arena_.size(); }

  private:
    /// A pair that is not proven at the highest feed of this call, and the distance that its box
    /// may use up.
    struct OpenPair {
        std::uint32_t task;
        double clearance_mm;
    };

    SpeedHint(const Machine& machine, Arena arena) noexcept
        : machine_(&machine), arena_(static_cast<Arena&&>(arena)) {}
    [[nodiscard]] std::uint32_t ask_far(const Engine& engine, const StopPlan& plan,
                                        double share) noexcept;
    void ask_clearances(const Engine& engine, std::uint32_t open) noexcept;

    const Machine* machine_;
    Arena arena_;
    std::span<Question> questions_;  // [pairs with each tool]
    std::span<Answer> answers_;
    std::span<OpenPair> open_;
    std::uint32_t questions_count_ = 0;
    std::uint8_t cap_ = 0;
};

}  // namespace axg
