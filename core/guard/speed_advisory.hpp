// SPDX-License-Identifier: Apache-2.0
// The speed cap of a cycle: the fastest feed at which a certificate would still hold a little
// later, if the axes go on as they do now. Runs after the certificate, with the rest of the cycle's
// queries. An advisory: no proof depends on it, and it assumes what no proof may assume: that the
// path does not turn before the axes obey the cap. mm and s, or rad and s. Source:
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

/// Time from the sample that a cap is computed from until the axes obey it, s: cap_lead_s of the
/// machine, plus half of the time in which the softest axis reverses its acceleration.
[[nodiscard]] double cap_lead_seconds(const Machine& machine) noexcept;

/// Returns the reach of the axes if each goes on with the speed and acceleration of the newest
/// snapshot for cap_lead_seconds, is then no faster than `share` of its largest speed, and then
/// moves as the certificate allows. A larger share never makes it smaller. Precondition: the
/// certificate noted a snapshot.
[[nodiscard]] JointBox capped_reach(const Machine& machine, const StopCertificate& certificate,
                                    double share) noexcept;

class SpeedAdvisory {
  public:
    /// `machine` must outlive it. Empty: memory ran out.
    [[nodiscard]] static std::optional<SpeedAdvisory> create(const Machine& machine);

    /// Computes the cap at the certificate's last `prove`, for the pairs it queried. The search
    /// continues from call to call: in one call the cap rises to at most little more than twice its
    /// value, or falls to a proven feed; after a few it is within 1/32 of the fastest proven feed.
    /// Cost: one query a pair in one batch, and up to kAdvisoryRounds batches more if some are not
    /// proven; never more than `queries`, the rest of the cycle's. With fewer than one a pair it
    /// makes no query, and the cap is 0.
    void update(const Engine& engine, const StopCertificate& certificate,
                std::uint32_t queries) noexcept;

    /// The same for a board that promised to obey caps. `order` is the last order. Precondition:
    /// the machine file has guard.cap.
    void update_order(const Engine& engine, const StopCertificate& certificate,
                      std::uint32_t queries, const CapOrder& order) noexcept;
    [[nodiscard]] const CapWish& wish() const noexcept { return wish_; }

    /// 1/250 of rapid; 0: no feed is proven, or not is_known().
    [[nodiscard]] std::uint8_t cap() const noexcept { return cap_; }
    /// Whether a cap can be computed: the certificate was settled, and no jog is on.
    [[nodiscard]] bool is_known() const noexcept { return is_known_; }
    [[nodiscard]] std::uint32_t queries() const noexcept { return queries_count_; }

    [[nodiscard]] std::size_t memory_bytes() const noexcept {
        return arena_.size() + prover_.memory_bytes();
    }

    static constexpr std::uint32_t kAdvisoryRounds =
        4;                                            // three halvings: eight boxes a pair and feed
    static constexpr std::uint32_t kOrderRounds = 6;  // the same for orders

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
    std::span<JointBoxTask> tasks_;  // [feeds or orders tried][pairs with each tool]
    std::span<JointBoxResult> results_;
    std::span<std::uint32_t> open_;  // pairs that the fastest feed leaves unproven
    std::uint32_t queries_count_ = 0;
    std::uint8_t cap_ = 0;
    CapWish wish_{};
    bool is_known_ = false;
};

}  // namespace axg
