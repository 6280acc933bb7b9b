// SPDX-License-Identifier: Apache-2.0
// The one narrow interface to every engine: queries about pairs of surfaces in, results out.
// Engines agree bit for bit, as far as "Agreement of engines" below states.
//
// is_farther(pair, pose, r): is every surface point of a, placed at `pose` in b's frame, more than
// r mm from every surface point of b? `far` is a theorem; anything else is `not_proven` and counts
// as near. The results depend only on trees, pose and capacities: never on the order of
// work, of lanes, or of early exits.
#pragma once

#include <cstdint>
#include <span>
#include <type_traits>

#include "core/base/pose.hpp"
#include "core/machine/cycle_work.hpp"

namespace axg {

enum class Proof : std::uint8_t { not_proven = 0, far = 1 };  // zeroed memory means near

enum class QueryStatus : std::uint8_t {
    not_run = 0,
    ok,
    too_many_node_pairs,  // a capacity was too small: not proven
    too_many_triangle_pairs,
    too_many_rechecks,
    bad_query,     // unknown mesh, pose not finite or too far away, r outside [0, kMarginMmMax]
    bad_rounding,  // the thread does not round to nearest, or flushes subnormals: no proof holds
    too_many_leaf_pairs,  // of a group
    too_many_box_rows,
};

enum class QueryKind : std::uint8_t {
    farther,    // proof only; leaves at the first pair of triangles that is not proven apart
    touching,   // proof, and the number (and list) of pairs of triangles not proven more than r
                // apart
    clearance,  // proof that the distance exceeds 0, and a certified lower bound of it up to r
};

inline constexpr double kMarginMmMax = 1.0e4;
inline constexpr double kRigidDefectMax =
    1.0e-9;  // largest |R^T R - I| entry the box tests allow for

struct TriangleIds {
    std::uint32_t a = 0, b = 0;  // indices into the two meshes

    friend constexpr auto operator<=>(const TriangleIds&, const TriangleIds&) = default;
};

struct Query {
    QueryKind kind = QueryKind::farther;
    // farther: a pair of triangles that float leaves undecided is near. The engine neither makes
    // nor counts a recheck.
    bool is_float_only = false;
    std::uint16_t group = 0;  // in a call with groups: index of the group that is charged
    std::uint32_t mesh_a = 0, mesh_b = 0;  // in the order of the engine's meshes
    double r_mm = 0;           // farther, touching: the margin; clearance: largest result
    double pose_error_mm = 0;  // how far any point of a may be from where `pose` puts it
    Pose pose;                 // a's mesh frame to b's; rigid to kRigidDefectMax
    std::span<TriangleIds>
        list{};  // touching: out, the first list.size() pairs found; may be empty
};

struct QueryResult {
    QueryStatus status = QueryStatus::not_run;
    Proof proof = Proof::not_proven;
    std::uint32_t touching = 0;  // pairs of triangles not proven apart
    double clearance_mm = 0;     // never more than the true distance; r_mm when nothing is nearer
    TriangleIds nearest{};       // clearance: the pair that set it, when it is below r_mm
    std::uint32_t node_pairs = 0, triangle_pairs = 0, rechecks = 0;  // work done
};

// Agreement of engines, for the same meshes and the same capacities per query:
// - All refuse the same queries (bad_query).
// - farther: equal `proof`; if it is far, every field is equal. Otherwise the CPU stops at the
//   first pair of triangles that touches, and other engines count on: status and counts may differ.
// - touching: the same queries exceed a capacity; without that, every field is equal. Lists hold
//   the same pairs, in any order; if there are more pairs than places, any of them.
// - clearance: if no engine exceeds a capacity, equal `status`, `proof` and `clearance_mm`, and
//   `nearest` unless several pairs are equally near. The work differs, so overflows differ.
// In a call with groups, for the same shares:
// - If no list of a group is full on either engine: all of the above.
// - If one is full, all queries of that group are not proven. The CPU does not charge the work that
//   an early exit saves: it may prove a group that overflows on another engine, never the reverse.
// An engine on another device may have lists that all queries of a call share; one that is full
// makes all of them not_proven. Status not_run: the engine is lost, and no proof holds.

/// The first full list of a group, in the order of WorkLists; ok: none is.
[[nodiscard]] constexpr QueryStatus first_full(const GroupWork& group) noexcept {
    const WorkLists &used = group.used, &share = group.share;
    return used.node_pairs > share.node_pairs           ? QueryStatus::too_many_node_pairs
           : used.leaf_pairs > share.leaf_pairs         ? QueryStatus::too_many_leaf_pairs
           : used.box_rows > share.box_rows             ? QueryStatus::too_many_box_rows
           : used.triangle_pairs > share.triangle_pairs ? QueryStatus::too_many_triangle_pairs
           : used.rechecks > share.rechecks             ? QueryStatus::too_many_rechecks
                                                        : QueryStatus::ok;
}

/// Whether a list was too short for the query or for its group.
[[nodiscard]] constexpr bool is_overflow(QueryStatus status) noexcept {
    return status == QueryStatus::too_many_node_pairs ||
           status == QueryStatus::too_many_leaf_pairs || status == QueryStatus::too_many_box_rows ||
           status == QueryStatus::too_many_triangle_pairs ||
           status == QueryStatus::too_many_rechecks;
}

struct PartQueries;  // core/collision/query_tree.hpp

/// The interface of an engine to the cycle. `run` processes every query; results[i] belongs to
/// queries[i]. Precondition: as many results as queries. Cost: bounded by the capacities that the
/// engine was created with.
struct Engine {
    void* self = nullptr;
    void (*run)(void* self, std::span<const Query> queries,
                std::span<QueryResult> results) noexcept = nullptr;
    // A call (a launch) costs more than many queries: callers put many queries into one call.
    bool prefers_batches = false;
    // As `run`, for queries in groups: charges the work of each to groups[query.group] and applies
    // no capacity per query. Refuses clearance queries (bad_query). Null: the engine has no groups
    // and applies its own capacities.
    void (*run_groups)(void* self, std::span<const Query> queries, std::span<QueryResult> results,
                       std::span<GroupWork> groups) noexcept = nullptr;

    // As `run_groups`, for parts of boxes in float only, which the engine poses itself, followed by
    // `queries`: as many results as both together. Null: the engine poses no parts.
    void (*run_parts)(void* self, const PartQueries& parts, std::span<const Query> queries,
                      std::span<QueryResult> results,
                      std::span<GroupWork> groups) noexcept = nullptr;
    std::uint32_t parts_max = 0;  // in one call, the queries after them included

    // The first `stages` stages of a cycle may run on an engine of the host: they have few queries,
    // and a launch costs more than those. Both engines return the same results (see above).
    struct Host {
        std::uint32_t stages = 0;
        void* self = nullptr;
        void (*run_groups)(void* self, std::span<const Query> queries,
                           std::span<QueryResult> results,
                           std::span<GroupWork> groups) noexcept = nullptr;
    } host{};

    /// The engine that runs a stage of a cycle.
    [[nodiscard]] Engine of_stage(std::uint32_t stage) const noexcept {
        return stage < host.stages ? Engine{.self = host.self, .run_groups = host.run_groups}
                                   : *this;
    }

    void operator()(std::span<const Query> queries, std::span<QueryResult> results) const noexcept {
        run(self, queries, results);
    }
    void operator()(std::span<const Query> queries, std::span<QueryResult> results,
                    std::span<GroupWork> groups) const noexcept {
        if (run_groups != nullptr) {
            run_groups(self, queries, results, groups);
        } else {
            run(self, queries, results);
        }
    }
};

}  // namespace axg
