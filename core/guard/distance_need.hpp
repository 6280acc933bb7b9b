// SPDX-License-Identifier: Apache-2.0
// Why a pair was not proven: the distance that its proof needs, in parts, against the distance
// available, and the changes that prove it. For reports, after the cycle.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "core/certificate/pair_queries.hpp"
#include "core/certificate/stop_certificate.hpp"
#include "core/collision/engine.hpp"
#include "core/machine/machine.hpp"

namespace axg {

/// Copy of one failed proof of a cycle, for use after the certificate's next cycle has begun.
struct UnprovenPair {
    bool is_known = false;
    // The reach is that of a look-ahead path or of a jog: it has no parts, and no speed to lower.
    bool is_whole = false;
    bool is_jog = false;            // the margin is the floor of the jog
    bool is_blind = false;          // too few data about the motion: no query was made
    std::uint32_t tool = kNoIndex;  // Machine::tools; kNoIndex: none in this pair
    JointBoxTask task;              // without pieces
    JointBoxResult result;
    AxisSnapshot snapshot;
    double free_s = 0;
    std::array<AxisRange, kAxesMax> now{};
    std::array<AxisLimits, kAxesMax> limits{};
    std::array<double, kAxesMax> position_error{};
};
/// The first proof of `pair` that failed in the certificate's last cycle.
[[nodiscard]] UnprovenPair unproven_pair(const Machine& machine, const StopCertificate& certificate,
                                         std::uint32_t pair) noexcept;

/// Distance at the sampled position that ensures the margin of the pair everywhere in the reach,
/// mm. With `is_whole`, `until_braking_mm` contains all motion.
struct DistanceNeed {
    double margin_mm = 0;
    double until_braking_mm = 0;      // motion at the speed now, until braking must have begun
    double braking_mm = 0;            // from there to standstill
    double position_error_mm = 0;     // uncertainty of the position
    double speed_uncertainty_mm = 0;  // uncertainty of speed and acceleration
    double arithmetic_mm = 0;         // placement, and simplified surfaces

    [[nodiscard]] double sum_mm() const noexcept {
        return margin_mm + until_braking_mm + braking_mm + position_error_mm +
               speed_uncertainty_mm + arithmetic_mm;
    }
};
[[nodiscard]] DistanceNeed distance_need(const Machine& machine, const UnprovenPair& pair) noexcept;

/// Certified clearance at the sampled position, mm, never more than `within_mm`. 0: none.
[[nodiscard]] double available_mm(const Machine& machine, const Engine& engine,
                                  const UnprovenPair& pair, double within_mm) noexcept;

/// Least clearance found at the sampled position, at the corners of the reach and at the centre of
/// the part that was left open, mm: an upper bound of the worst case. Never more than `within_mm`.
/// Cost: one query a corner, at most 2^kAxesMax.
[[nodiscard]] double least_clearance_mm(const Machine& machine, const Engine& engine,
                                        const UnprovenPair& pair, double within_mm) noexcept;

/// The first part of the reach that the halving left open: the same two figures at its centre.
struct OpenPart {
    double needed_mm = 0, available_mm = 0;
};
/// Empty: the reach was not halved.
[[nodiscard]] std::optional<OpenPart> open_part(const Machine& machine, const Engine& engine,
                                                const UnprovenPair& pair) noexcept;

// Clearances are of interest up to this, mm, and further where a proof needs more.
inline constexpr double kClearanceWithinMm = 50.0;

/// Needed against available distance of one pair that was not proven.
struct PairDistances {
    DistanceNeed need;
    double available_mm = 0;  // certified at the sampled position; 0: none
    double within_mm = 0;     // upper limit of `available_mm`
    std::optional<OpenPart> open;
};
/// Stoppable mode. Precondition: `pair` has `is_known`, and not `is_blind`.
/// Cost: the need, and two queries.
[[nodiscard]] PairDistances pair_distances(const Machine& machine, const Engine& engine,
                                           const UnprovenPair& pair) noexcept;

/// What one query of the whole reach takes from the engine's lists, if it proves the pair. Empty:
/// it does not, or the engine has no groups.
[[nodiscard]] std::optional<WorkLists> whole_demand(const Machine& machine, const Engine& engine,
                                                    const UnprovenPair& pair) noexcept;

/// Contact mode: the query of the pair at the sampled pose. Empty: there is none.
/// @param room  memory for all queries of that pose
[[nodiscard]] std::optional<Query> pose_query(const Machine& machine, const AxisSnapshot& snapshot,
                                              std::uint32_t pair, PairQueries& room) noexcept;
/// The distances at that pose: the need consists of margin and arithmetic only.
[[nodiscard]] PairDistances pose_distances(const Engine& engine, const Query& query) noexcept;

/// Changes for a second proof of the pair.
struct ProofChange {
    double speed_share = 1;
    double margin_share = 1;
    const std::array<AxisLimits, kAxesMax>* limits = nullptr;  // in place of the pair's
};
/// Whether the pair is proven over its reach after the change, as the only pair, with the plan in
/// force.
[[nodiscard]] bool is_proven_with(const Machine& machine, const Engine& engine,
                                  const UnprovenPair& pair, const ProofChange& change);

/// Changes that prove the pair; each was queried again. Empty: none of them does.
struct NeedRemedies {
    bool is_alone = false;  // proven as the only pair: in the cycle, pairs share the lists
    std::optional<double> speed_share;
    std::optional<double> margin_mm;       // less than the pair's
    std::optional<std::uint32_t> queries;  // used with a larger plan
    bool are_other_limits = false;         // with the limits that were passed
};
struct RemedySearch {
    bool tries_plans = true;  // no use if a position in the reach is too near
    const std::array<AxisLimits, kAxesMax>* limits = nullptr;  // tried too; null: none
};
/// Allocates memory for each plan that it tries. Not for a cycle.
/// Cost: at most the plan 18 times, and 36'864 queries if it tries plans.
[[nodiscard]] NeedRemedies find_remedies(const Machine& machine, const Engine& engine,
                                         const UnprovenPair& pair, const RemedySearch& search);

}  // namespace axg
