// SPDX-License-Identifier: Apache-2.0
#include "core/guard/distance_need.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/machine/cycle_plan.hpp"
#include "core/machine/kinematics.hpp"

namespace axg {
namespace {

constexpr std::uint32_t kSteps = 100;  // a share of speed or margin is found to 1 %
// So hard that braking and jerk add practically no distance.
constexpr double kHardStop = 1e9, kHardJerk = 1e15;
constexpr std::array<JointBoxBudget, 2> kLargerPlans{
    {{.rounds = 10, .queries = 4096}, {.rounds = 13, .queries = 32'768}}};

/// Multiplies the middle of a range by `share`; the width stays the same.
void scale_middle(double& low, double& high, double share) noexcept {
    const double middle = 0.5 * (low + high), half = 0.5 * (high - low);
    low = share * middle - half;
    high = share * middle + half;
}

bool is_acceleration_known(const AxisRange& range) noexcept {
    return std::isfinite(range.acceleration_low) && std::isfinite(range.acceleration_high);
}

/// Slows motion on the same path: accelerations shrink with the square of the share.
AxisRange slower(AxisRange now, double share) noexcept {
    scale_middle(now.speed_low, now.speed_high, share);
    if (is_acceleration_known(now)) {
        scale_middle(now.acceleration_low, now.acceleration_high, share * share);
    }
    return now;
}

/// Replaces speed and acceleration by the middles of their ranges, as if they were exact.
AxisRange exact_motion(AxisRange now) noexcept {
    now.speed_low = now.speed_high = 0.5 * (now.speed_low + now.speed_high);
    if (is_acceleration_known(now)) {
        now.acceleration_low = now.acceleration_high =
            0.5 * (now.acceleration_low + now.acceleration_high);
    }
    return now;
}

AxisRange exactly_at(AxisRange now, double position) noexcept {
    now.low = now.high = position;
    return now;
}

/// Sets the axis' interval: centred at the sampled position, wide enough for the range.
void put_about(const ReachRange& range, double position, std::uint32_t axis,
               JointBox& box) noexcept {
    box.centre[axis] = position;
    box.half[axis] = std::max({0.0, range.high - position, position - range.low});
}

double motion_mm(const Machine& machine, const JointBoxTask& task, const JointBox& box) noexcept {
    std::array<Pose, kBodiesMax> moved;
    move_bodies(machine, box.centre, moved);
    const PlacedPair pair = placed_pair(task, moved);
    return motion_along(machine, task.path, moved, pair.a, pair.b, box).total_mm;
}

double clearance_at(const Machine& machine, const Engine& engine, const JointBoxTask& task,
                    std::span<const double> position, double within_mm) noexcept {
    std::array<Pose, kBodiesMax> moved;
    move_bodies(machine, position, moved);
    Query query = query_of(task, placed_pair(task, moved), within_mm);
    query.kind = QueryKind::clearance;
    QueryResult result;
    engine({&query, 1}, {&result, 1});
    return result.status == QueryStatus::ok ? result.clearance_mm : 0;
}

JointBox box_with(const Machine& machine, const UnprovenPair& pair,
                  const ProofChange& change) noexcept {
    if (pair.is_whole || (change.speed_share >= 1 && change.limits == nullptr)) {
        return pair.task.box;
    }
    JointBox box;
    for (std::uint32_t i = 0; i < machine.axes.size(); ++i) {
        const AxisLimits& limits = change.limits != nullptr ? (*change.limits)[i] : pair.limits[i];
        put_reach(axis_reach(machine, i, limits, slower(pair.now[i], change.speed_share),
                             pair.free_s, pair.position_error[i]),
                  i, box);
    }
    return box;
}

bool is_proven_by(StagedProver& prover, const Machine& machine, const Engine& engine,
                  const UnprovenPair& pair, const ProofChange& change) noexcept {
    JointBoxTask task = pair.task;
    task.box = box_with(machine, pair, change);
    task.margin_mm *= change.margin_share;
    JointBoxResult result;
    prover.prove(engine, {&task, 1}, {&result, 1});
    return result.proof == JointBoxProof::proven;
}

std::optional<StagedProver> prover_in_force(const Machine& machine) {
    return StagedProver::create(machine, 1, cycle_plan(machine, stop_tasks(machine)), kNoIndex);
}

/// Returns the largest proven share, if each step is harder to prove. A share of 1 is not proven.
template <class Proves>
std::optional<double> largest_share(const Proves& is_proven) noexcept {
    if (!is_proven(0.0)) {
        return std::nullopt;
    }
    const auto share = [](std::uint32_t step) { return static_cast<double>(step) / kSteps; };
    std::uint32_t low = 0, high = kSteps;  // low is proven, high is not
    while (high - low > 1) {
        const std::uint32_t middle = (low + high) / 2;
        (is_proven(share(middle)) ? low : high) = middle;
    }
    return share(low);
}

std::optional<std::uint32_t> larger_plan(const Machine& machine, const Engine& engine,
                                         const UnprovenPair& pair) {
    for (const JointBoxBudget& budget : kLargerPlans) {
        auto prover = JointBoxProver::create(machine, 1, budget);
        JointBoxResult result;
        if (prover) {
            prover->prove(engine, {&pair.task, 1}, {&result, 1});
        }
        if (result.proof == JointBoxProof::proven) {
            return result.queries;
        }
    }
    return std::nullopt;
}

}  // namespace

UnprovenPair unproven_pair(const Machine& machine, const StopCertificate& certificate,
                           std::uint32_t pair) noexcept {
    UnprovenPair out;
    const StopCycle cycle = certificate.cycle();
    for (std::size_t i = 0; i < cycle.proofs.size() && !out.is_known; ++i) {
        const PairProof& proof = cycle.proofs[i];
        if (proof.pair != pair || proof.surfaces.proof == JointBoxProof::proven) {
            continue;
        }
        out.is_known = true;
        out.tool = proof.tool;
        out.task = certificate.tasks()[i];
        out.is_jog = cycle.is_jog;
        out.is_whole = cycle.is_jog || !out.task.pieces.empty() ||
                       machine.guard.promise == StopPromise::path_keeping;
        out.task.pieces = {};
        out.result = proof.surfaces;
        out.is_blind = out.result.queries == 0 && out.result.status == QueryStatus::not_run;
        out.snapshot = certificate.snapshot();
        // A longer permit that was not proven is no reason for a stop.
        out.free_s = free_seconds(machine, machine.can.permit_samples.least);
        for (std::uint32_t k = 0; k < machine.axes.size(); ++k) {
            out.now[k] = certificate.now(k);
            out.limits[k] = certificate.bounded_limits(k);
            out.position_error[k] = certificate.held_error(k) - machine.axes[k].following_error;
        }
    }
    return out;
}

DistanceNeed distance_need(const Machine& machine, const UnprovenPair& pair) noexcept {
    DistanceNeed out;
    out.margin_mm = pair.task.margin_mm;
    out.arithmetic_mm = pair.task.pose_error_mm;
    JointBox free, braked, placed, all;
    for (std::uint32_t i = 0; i < machine.axes.size(); ++i) {
        const double at = pair.snapshot.position[i];
        const JointBox& box = pair.task.box;
        put_about({box.centre[i] - box.half[i], box.centre[i] + box.half[i]}, at, i, all);
        const AxisRange known = exact_motion(pair.now[i]), exact = exactly_at(known, at);
        AxisLimits hard = pair.limits[i];
        hard.stopping_min = kHardStop;
        hard.jerk_max = kHardJerk;
        put_about(axis_reach(machine, i, hard, exact, pair.free_s, 0), at, i, free);
        put_about(axis_reach(machine, i, pair.limits[i], exact, pair.free_s, 0), at, i, braked);
        put_about(
            axis_reach(machine, i, pair.limits[i], known, pair.free_s, pair.position_error[i]), at,
            i, placed);
    }
    const double whole_mm = motion_mm(machine, pair.task, all);
    if (pair.is_whole) {
        out.until_braking_mm = whole_mm;
        return out;
    }
    // Each part is its addition to the parts before it. A limited jerk may make a sum smaller.
    const double placed_mm = std::min(motion_mm(machine, pair.task, placed), whole_mm);
    const double braked_mm = std::min(motion_mm(machine, pair.task, braked), placed_mm);
    out.until_braking_mm = std::min(motion_mm(machine, pair.task, free), braked_mm);
    out.braking_mm = braked_mm - out.until_braking_mm;
    out.position_error_mm = placed_mm - braked_mm;
    out.speed_uncertainty_mm = whole_mm - placed_mm;
    return out;
}

double available_mm(const Machine& machine, const Engine& engine, const UnprovenPair& pair,
                    double within_mm) noexcept {
    return clearance_at(machine, engine, pair.task, pair.snapshot.position, within_mm);
}

double least_clearance_mm(const Machine& machine, const Engine& engine, const UnprovenPair& pair,
                          double within_mm) noexcept {
    std::array<std::uint32_t, kAxesMax> axes{};
    std::uint32_t count = 0;
    for (std::uint32_t k = 0; k < pair.task.path.count; ++k) {
        const std::uint32_t axis = machine.bodies[pair.task.path.body[k]].joint.axis;
        const auto* const end = axes.begin() + count;
        if (std::find(axes.cbegin(), end, axis) == end) {
            axes[count++] = axis;
        }
    }
    const JointBox& box = pair.task.box;
    double least_mm = available_mm(machine, engine, pair, within_mm);
    for (std::uint32_t corner = 0; corner < 1U << count; ++corner) {
        std::array<double, kAxesMax> position = pair.snapshot.position;
        for (std::uint32_t k = 0; k < count; ++k) {
            const double half = box.half[axes[k]];
            position[axes[k]] = box.centre[axes[k]] + ((corner >> k & 1U) != 0 ? half : -half);
        }
        least_mm =
            std::min(least_mm, clearance_at(machine, engine, pair.task, position, within_mm));
    }
    if (pair.result.proof == JointBoxProof::budget_spent) {
        least_mm = std::min(
            least_mm, clearance_at(machine, engine, pair.task, pair.result.open.centre, within_mm));
    }
    return least_mm;
}

std::optional<OpenPart> open_part(const Machine& machine, const Engine& engine,
                                  const UnprovenPair& pair) noexcept {
    const JointBox &open = pair.result.open, &box = pair.task.box;
    bool is_halved = false;
    for (std::uint32_t i = 0; i < machine.axes.size(); ++i) {
        is_halved = is_halved || open.half[i] < box.half[i];
    }
    if (!is_halved || pair.is_blind || pair.result.proof != JointBoxProof::budget_spent) {
        return std::nullopt;
    }
    OpenPart out;
    out.needed_mm =
        pair.task.margin_mm + pair.task.pose_error_mm + motion_mm(machine, pair.task, open);
    out.available_mm =
        clearance_at(machine, engine, pair.task, open.centre, std::max(1.0, out.needed_mm));
    return out;
}

PairDistances pair_distances(const Machine& machine, const Engine& engine,
                             const UnprovenPair& pair) noexcept {
    PairDistances out;
    out.need = distance_need(machine, pair);
    out.within_mm = std::clamp(out.need.sum_mm(), kClearanceWithinMm, kMarginMmMax);
    out.available_mm = available_mm(machine, engine, pair, out.within_mm);
    out.open = open_part(machine, engine, pair);
    return out;
}

std::optional<WorkLists> whole_demand(const Machine& machine, const Engine& engine,
                                      const UnprovenPair& pair) noexcept {
    if (engine.run_groups == nullptr || pair.is_blind) {
        return std::nullopt;
    }
    const JointBoxTask& task = pair.task;
    std::array<Pose, kBodiesMax> moved;
    move_bodies(machine, task.box.centre, moved);
    Query query = query_of(task, placed_pair(task, moved),
                           task.margin_mm + motion_mm(machine, task, task.box));
    query.is_float_only = true;  // as in a cycle
    QueryResult result;
    GroupWork group;
    for (const WorkListName& one : kWorkLists) {
        group.share.*one.list = std::numeric_limits<std::uint32_t>::max();
    }
    engine({&query, 1}, {&result, 1}, {&group, 1});
    return result.status == QueryStatus::ok && result.proof == Proof::far
               ? std::optional(group.used)
               : std::nullopt;
}

std::optional<Query> pose_query(const Machine& machine, const AxisSnapshot& snapshot,
                                std::uint32_t pair, PairQueries& room) noexcept {
    make_contact_queries(machine, snapshot, room);
    for (std::uint32_t i = 0; room.status == SnapshotStatus::ok && i < room.count; ++i) {
        if (room.pair[i] == pair) {
            return room.queries[i];
        }
    }
    return std::nullopt;
}

PairDistances pose_distances(const Engine& engine, const Query& query) noexcept {
    PairDistances out;
    out.need.margin_mm = query.r_mm;
    out.need.arithmetic_mm = query.pose_error_mm;
    out.within_mm = std::max(kClearanceWithinMm, 2 * query.r_mm);
    Query clearance = query;
    clearance.kind = QueryKind::clearance;
    clearance.r_mm = out.within_mm;
    QueryResult result;
    engine({&clearance, 1}, {&result, 1});
    out.available_mm = result.status == QueryStatus::ok ? result.clearance_mm : 0;
    return out;
}

bool is_proven_with(const Machine& machine, const Engine& engine, const UnprovenPair& pair,
                    const ProofChange& change) {
    auto prover = prover_in_force(machine);
    return prover && is_proven_by(*prover, machine, engine, pair, change);
}

NeedRemedies find_remedies(const Machine& machine, const Engine& engine, const UnprovenPair& pair,
                           const RemedySearch& search) {
    NeedRemedies out;
    auto prover = prover_in_force(machine);
    if (!prover || pair.is_blind) {
        return out;
    }
    const auto is_proven = [&](const ProofChange& change) {
        return is_proven_by(*prover, machine, engine, pair, change);
    };
    out.is_alone = is_proven({});
    if (out.is_alone) {
        return out;
    }
    if (!pair.is_whole) {
        out.speed_share =
            largest_share([&](double share) { return is_proven({.speed_share = share}); });
        out.are_other_limits = search.limits != nullptr && is_proven({.limits = search.limits});
    }
    if (pair.task.margin_mm > 0 && !pair.is_jog) {
        const auto share =
            largest_share([&](double of) { return is_proven({.margin_share = of}); });
        out.margin_mm = share ? std::optional<double>(pair.task.margin_mm * *share) : std::nullopt;
    }
    if (search.tries_plans) {
        out.queries = larger_plan(machine, engine, pair);
    }
    return out;
}

}  // namespace axg
