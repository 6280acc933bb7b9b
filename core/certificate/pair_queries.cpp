// SPDX-License-Identifier: Apache-2.0
#include "core/certificate/pair_queries.hpp"

#include <cmath>
#include <cstddef>
#include <span>

#include "core/base/finite.hpp"
#include "core/base/sincos.hpp"
#include "core/certificate/travel.hpp"
#include "core/collision/containment.hpp"
#include "core/machine/kinematics.hpp"

namespace axg {

namespace {

/// The slot of a tool number; kNoIndex when there is none.
std::uint32_t find_tool(const Machine& machine, std::uint16_t number) noexcept {
    for (std::size_t i = 0; i < machine.tools.size(); ++i) {
        if (machine.tools[i].number == number) {
            return static_cast<std::uint32_t>(i);
        }
    }
    return kNoIndex;
}

/// Whether the cost of stated errors holds there.
bool is_within_errors(const Machine& machine, std::span<const double> position) noexcept {
    const PoseErrors& errors = machine.pose_errors;
    bool is_within = true;
    for (std::size_t i = 0; errors.are_stated && i < machine.axes.size(); ++i) {
        is_within = is_within && (machine.axes[i].kind == AxisKind::rotary ||
                                  std::fabs(position[i]) <= errors.within[i]);
    }
    return is_within;
}

SnapshotStatus judge_positions(const Machine& machine, const AxisSnapshot& snapshot) noexcept {
    if (snapshot.axis_count != machine.axes.size()) {
        return SnapshotStatus::wrong_axes;
    }
    for (std::size_t i = 0; i < machine.axes.size(); ++i) {
        const double limit =
            machine.axes[i].kind == AxisKind::rotary ? kSinCosArgumentMax : kCoordinateMmMax;
        const double at = snapshot.position[i];
        if (!is_finite(at) || !(at >= -limit && at <= limit)) {
            return SnapshotStatus::not_finite;
        }
    }
    return is_in_travel(machine, snapshot.position) && is_within_errors(machine, snapshot.position)
               ? SnapshotStatus::ok
               : SnapshotStatus::left_travel;
}

}  // namespace

std::uint32_t mesh_in_pair(const Machine& machine, std::uint32_t body, std::uint32_t against,
                           std::uint32_t tool) noexcept {
    const bool is_tool = machine.bodies[body].is_tool;
    if (is_tool && tool == kNoIndex) {
        return kNoIndex;
    }
    const std::uint32_t in_pair = is_tool || machine.bodies[against].is_tool ? tool : kNoIndex;
    for (const PairSurface& own : machine.pair_surfaces) {
        if (own.body == body && own.against == against && own.tool == in_pair) {
            return pair_mesh_index(machine, own.surface);
        }
    }
    return is_tool ? tool_mesh_index(machine, tool) : body;
}

SnapshotStatus judge_snapshot(const Machine& machine, const AxisSnapshot& snapshot,
                              std::uint32_t& tool) noexcept {
    tool = kNoIndex;
    const SnapshotStatus status = judge_positions(machine, snapshot);
    const std::uint16_t number = snapshot.tool != 0 ? snapshot.tool : machine.first_tool;
    if (status != SnapshotStatus::ok || number == 0) {
        return status;
    }
    tool = find_tool(machine, number);
    return tool == kNoIndex ? SnapshotStatus::unknown_tool : SnapshotStatus::ok;
}

void make_contact_queries(const Machine& machine, const AxisSnapshot& snapshot, PairQueries& out,
                          QueryScope scope) noexcept {
    out.count = 0;
    out.status = judge_snapshot(machine, snapshot, out.tool);
    if (out.status != SnapshotStatus::ok) {
        return;
    }
    std::array<Pose, kBodiesMax> placed;
    place_bodies(machine, snapshot.position, placed);
    for (std::uint32_t i = 0; i < machine.bodies.size(); ++i) {
        if (machine.bodies[i].is_tool && out.tool != kNoIndex) {
            placed[i] = compose(placed[i], machine.tools[out.tool].at);
        }
    }
    std::uint32_t next_proof = 0;
    for (std::uint32_t i = 0; i < machine.pairs.size(); ++i) {
        const Pair& pair = machine.pairs[i];
        const std::uint32_t proof = next_proof + (has_tool(machine, pair) ? out.tool : 0);
        next_proof += tasks_of(machine, pair);
        const std::uint32_t mesh_a = mesh_in_pair(machine, pair.a, pair.b, out.tool);
        const std::uint32_t mesh_b = mesh_in_pair(machine, pair.b, pair.a, out.tool);
        if (mesh_a == kNoIndex || mesh_b == kNoIndex) {
            continue;
        }
        // judge_snapshot has rejected snapshots outside the travel.
        const TravelProof known =
            scope == QueryScope::needed ? travel_proof(machine, proof) : TravelProof{};
        const bool is_known = known.distance_mm >= pair.margin_mm;
        if (is_known && known.is_apart) {
            continue;
        }
        Query& q = out.queries[out.count];
        q = Query{};
        q.mesh_a = is_known ? pruned_mesh_index(machine, known.surface_a, mesh_a) : mesh_a;
        q.mesh_b = is_known ? pruned_mesh_index(machine, known.surface_b, mesh_b) : mesh_b;
        q.r_mm = pair.margin_mm;
        // Must not be 0: core/collision/containment.hpp continues from the result.
        q.pose_error_mm = kPlaceErrorMm + pose_error_of(machine, i) +
                          deviation_of(machine, pair.a, out.tool) +
                          deviation_of(machine, pair.b, out.tool);
        q.pose = relative_pose(placed[pair.a], placed[pair.b]);
        out.pair[out.count++] = i;
    }
    out.queries[out.count] = known_answer_query(known_answer_mesh_index(machine), false);
    out.queries[out.count + 1] = known_answer_query(known_answer_mesh_index(machine), true);
}

}  // namespace axg
