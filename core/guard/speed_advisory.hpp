// SPDX-License-Identifier: Apache-2.0
// The speed cap of a cycle: the fastest feed at which a certificate would still hold a little
// later, if the axes go on as they do now. Run after the certificate, with what that has left of
// the cycle's queries. An advisory: it enters no proof, and supposes what no proof may suppose,
// that the path does not turn before the cap is obeyed. mm and s, or rad and s. Source:
// docs/theory/certificate.md, "The speed cap".
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "core/base/arena.hpp"
#include "core/certificate/joint_box_proof.hpp"
#include "core/certificate/joint_path.hpp"
#include "core/certificate/stop_certificate.hpp"
#include "core/collision/engine.hpp"
#include "core/guard/advisories.hpp"
#include "core/guard/cap_control.hpp"
#include "core/machine/machine.hpp"

namespace axg {

/// From the sample that a cap is computed of until the axes obey it, s: what the machine file says,
/// and half of the time in which the softest axis turns its acceleration round.
[[nodiscard]] double cap_lead_seconds(const Machine& machine) noexcept;

/// Where the axes can get, were each to go on with the speed and acceleration of the newest
/// snapshot for as long as a cap takes to be obeyed, no faster than `share` of its largest speed,
/// and then as the certificate allows for. A larger share never makes it smaller. Precondition: the
/// certificate noted a snapshot.
[[nodiscard]] JointBox capped_reach(const Machine& machine, const StopCertificate& certificate,
                                    double share) noexcept;

class SpeedAdvisory {
  public:
    /// `machine` must outlive it. Empty: memory ran out.
    [[nodiscard]] static std::optional<SpeedAdvisory> create(const Machine& machine);

    /// The cap at the certificate's last `prove`, of the pairs that were queried. The search goes
    /// on from call to call: the cap rises to little more than twice its value in one, and falls at
    /// once to a feed that is proven, within a thirty-second part of the fastest after a few.
    /// Cost: one query a pair in one batch, and where some are not proven up to kAdvisoryRounds
    /// batches more; never more than `queries`, what the cycle has left. Where that is fewer than
    /// one a pair nothing is queried, and the cap is 0.
    void update(const Engine& engine, const StopCertificate& certificate,
                std::uint32_t queries) noexcept;

    /// The same of a board that promised to keep its axes within a cap, where `order` was ordered
    /// last. Precondition: the machine file has guard.cap.
    void update_order(const Engine& engine, const StopCertificate& certificate,
                      std::uint32_t queries, const CapOrder& order) noexcept;
    [[nodiscard]] const CapWish& wish() const noexcept { return wish_; }

    /// 1/250 of rapid; 0: no feed is proven, or nothing is known.
    [[nodiscard]] std::uint8_t cap() const noexcept { return cap_; }
    /// Something is: the certificate was settled, and no jog is on.
    [[nodiscard]] bool is_known() const noexcept { return is_known_; }
    [[nodiscard]] std::uint32_t queries() const noexcept { return queries_count_; }

    [[nodiscard]] std::size_t memory_bytes() const noexcept {
        return arena_.size() + prover_.memory_bytes();
    }

    static constexpr std::uint32_t kAdvisoryRounds =
        4;                                            // three halvings: eight boxes a pair and feed
    static constexpr std::uint32_t kOrderRounds = 6;  // the same of orders

  private:
    SpeedAdvisory(const Machine& machine, JointBoxProver prover, Arena arena) noexcept
        : machine_(&machine),
          prover_(static_cast<JointBoxProver&&>(prover)),
          arena_(static_cast<Arena&&>(arena)) {}
    [[nodiscard]] std::uint8_t search(const Engine& engine, const StopCertificate& certificate,
                                      std::uint32_t last, std::uint32_t queries) noexcept;
    [[nodiscard]] CapWish search_orders(const Engine& engine, const StopCertificate& certificate,
                                        std::uint32_t queries, const CapOrder& order) noexcept;
    [[nodiscard]] std::uint32_t prove_widest(const Engine& engine, const JointBox& widest,
                                             std::span<const JointBoxTask> pairs,
                                             std::uint32_t queries) noexcept;
    void put(std::uint32_t at, const JointBoxTask& pair, const JointBox& box) noexcept;
    [[nodiscard]] bool are_proven(std::uint32_t first, std::uint32_t count) const noexcept;
    void prove(const Engine& engine, std::uint32_t tasks, const JointBoxSpend& spend) noexcept;

    const Machine* machine_;
    JointBoxProver prover_;
    Arena arena_;
    std::span<JointBoxTask> tasks_;  // [feeds that are looked at][pairs with each tool]
    std::span<JointBoxResult> results_;
    std::span<std::uint32_t> open_;  // pairs that the fastest feed leaves unproven
    std::uint32_t queries_count_ = 0;
    std::uint8_t cap_ = 0;
    CapWish wish_{};
    bool is_known_ = false;
};

}  // namespace axg
