// SPDX-License-Identifier: Apache-2.0
// The ways out after a stop: which axis, moved by one step in which direction, gives the nearest
// pair more clearance, proven along the whole step. Bounded work, for a machine at rest: never in a
// cycle that still proves. mm, rad. Source: docs/theory/certificate.md, "Ways out".
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "core/base/arena.hpp"
#include "core/base/sincos.hpp"
#include "core/certificate/joint_box_proof.hpp"
#include "core/certificate/stop_certificate.hpp"
#include "core/collision/containment.hpp"
#include "core/collision/engine.hpp"
#include "core/machine/machine.hpp"

namespace axg {

inline constexpr double kEscapeStepMm = 1.0;           // of a linear axis
inline constexpr double kEscapeStepRad = kPi / 360.0;  // of a rotary one: half a degree
inline constexpr double kEscapeGainMm = 0.01;          // less is no way out
inline constexpr double kEscapeWithinMm = 50.0;        // no pair nearer: no obstacle to leave
inline constexpr std::uint32_t kEscapeRounds = 7;      // of a proof: six halvings
inline constexpr std::uint32_t kEscapeQueries = 512;

struct EscapeJog {
    std::uint32_t axis = kNoIndex;
    bool is_negative = false;
    double clearance_mm = 0;  // of every pair after the step, at least
};

struct Escapes {
    // Every pair is proven apart, and none inside the other. Else no way out can be proven.
    bool is_clear = false;
    double clearance_mm = 0;        // of every pair now, at least; up to kEscapeWithinMm
    std::uint32_t pair = kNoIndex;  // Machine::pairs: the nearest
    std::uint32_t count = 0;
    std::array<EscapeJog, 2 * std::size_t{kAxesMax}> jogs{};  // the most clearance first

    [[nodiscard]] std::span<const EscapeJog> list() const noexcept { return {jogs.data(), count}; }
};

class EscapeFinder {
  public:
    /// `machine` must outlive it. Empty: memory ran out.
    [[nodiscard]] static std::optional<EscapeFinder> create(const Machine& machine);

    /// Starts from the position of the certificate's last `prove`, for the pairs it queried. A way
    /// out ends within the travel, with at least kEscapeGainMm more clearance for the nearest pair;
    /// along it every pair is proven farther apart than jog_floor_mm, for all axis positions within
    /// their errors. Cost: two batches of a query a pair, and the prover's batches (kEscapeRounds,
    /// kEscapeQueries), for each axis and direction.
    [[nodiscard]] Escapes find(const Engine& engine, const ContainmentTest& containment_test,
                               const StopCertificate& certificate) noexcept;

  private:
    EscapeFinder(const Machine& machine, JointBoxProver prover, Arena arena) noexcept
        : machine_(&machine), prover_(std::move(prover)), arena_(std::move(arena)) {}
    void query_clearances(const Engine& engine, std::span<const JointBoxTask> tasks,
                          std::span<const double> position, double within_mm) noexcept;
    void judge_now(const Engine& engine, const ContainmentTest& containment_test,
                   const StopCertificate& certificate, Escapes& out) noexcept;
    [[nodiscard]] bool is_way_proven(const Engine& engine, const StopCertificate& certificate,
                                     std::uint32_t axis, double target) noexcept;
    void try_jog(const Engine& engine, const StopCertificate& certificate, EscapeJog jog,
                 Escapes& out) noexcept;

    const Machine* machine_;
    JointBoxProver prover_;
    Arena arena_;
    std::span<Query> queries_;  // [pairs with each tool], as all of these
    std::span<QueryResult> query_results_;
    std::span<JointBoxTask> tasks_;
    std::span<JointBoxResult> results_;
    std::span<double> floors_;
};

}  // namespace axg
