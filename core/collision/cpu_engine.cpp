// SPDX-License-Identifier: Apache-2.0
#include "core/collision/cpu_engine.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "core/base/assert.hpp"
#include "core/base/fetch.hpp"
#include "core/base/rounding_mode.hpp"

namespace axg {

namespace {

constexpr std::size_t kKeys = std::size_t{kNodeWidth} * kNodeWidth;

std::size_t lists_bytes(const Capacities& capacities) noexcept {
    return Arena::size_bytes<NodePair>(capacities.node_pairs) +
           Arena::size_bytes<std::uint64_t>(kKeys);
}

const LaneKernels* kernels_of(LaneSet lanes) noexcept {
    switch (lanes) {
        case LaneSet::avx512:
            return avx512_kernels();
        case LaneSet::avx2:
            return avx2_kernels();
        case LaneSet::neon:
            return neon_kernels();
        case LaneSet::widest:
            break;
    }
    for (const LaneSet set : {LaneSet::avx512, LaneSet::avx2, LaneSet::neon}) {
        if (has_lane_set(set)) {
            return kernels_of(set);
        }
    }
    return nullptr;
}

/// Prefetches the roots of the next query's trees, except those that this query uses.
void fetch_roots(std::span<const Tree> trees, const Query& now, const Query& next) noexcept {
    for (const auto mesh : {&Query::mesh_a, &Query::mesh_b}) {
        if (next.*mesh != now.*mesh && next.*mesh < trees.size() &&
            !trees[next.*mesh].nodes.empty()) {
            fetch(trees[next.*mesh].nodes[0]);
        }
    }
}

}  // namespace

bool has_lane_set(LaneSet lanes) noexcept {
    switch (lanes) {
#if defined(__x86_64__)
        // Every extension that core/collision/CMakeLists.txt lets the compiler use there.
        case LaneSet::avx512:
            return avx512_kernels() != nullptr && __builtin_cpu_supports("avx512f") != 0 &&
                   __builtin_cpu_supports("avx512vl") != 0 &&
                   __builtin_cpu_supports("avx512dq") != 0 &&
                   __builtin_cpu_supports("avx512bw") != 0 && __builtin_cpu_supports("fma") != 0 &&
                   __builtin_cpu_supports("bmi2") != 0;
        case LaneSet::avx2:
            return avx2_kernels() != nullptr && __builtin_cpu_supports("avx2") != 0 &&
                   __builtin_cpu_supports("fma") != 0 && __builtin_cpu_supports("bmi2") != 0;
#endif
        case LaneSet::neon:
            return neon_kernels() != nullptr;
        case LaneSet::widest:
            return kernels_of(LaneSet::widest) != nullptr;
        default:
            return false;
    }
}

const LaneKernels* lane_kernels(LaneSet lanes) noexcept {
    return has_lane_set(lanes) ? kernels_of(lanes) : nullptr;
}

CpuEngine::CpuEngine(Arena arena, const LaneKernels* kernels) noexcept
    : arena_(std::move(arena)), kernels_(kernels) {}

std::optional<CpuEngine> CpuEngine::create(std::span<const Mesh* const> meshes,
                                           const Capacities& capacities, LaneSet lanes) {
    if (!has_lane_set(lanes)) {
        return std::nullopt;
    }
    std::vector<TreeShape> shapes(meshes.size());
    MemoryPlan memory_plan;
    memory_plan.trees_bytes = Arena::size_bytes<Tree>(meshes.size());
    for (std::size_t i = 0; i < meshes.size(); ++i) {
        if (has_usable_triangles(*meshes[i])) {
            shapes[i] = shape_of(*meshes[i]);
            const TreeSize size = size_of(shapes[i]);
            memory_plan.trees_bytes += Arena::size_bytes<TreeNode>(size.nodes) +
                                       Arena::size_bytes<TreeLeaf>(size.leaves) +
                                       Arena::size_bytes<LeafCorners>(size.leaves);
        }
    }
    memory_plan.lists_bytes = lists_bytes(capacities);
    Arena arena(memory_plan.total_bytes());
    if (!arena.ok()) {
        return std::nullopt;
    }
    CpuEngine engine(std::move(arena), kernels_of(lanes));
    engine.memory_plan_ = memory_plan;
    engine.trees_ = engine.arena_.take<Tree>(meshes.size());
    for (std::size_t i = 0; i < meshes.size(); ++i) {
        const TreeSize size = size_of(shapes[i]);
        const std::span<TreeNode> nodes = engine.arena_.take<TreeNode>(size.nodes);
        const std::span<TreeLeaf> leaves = engine.arena_.take<TreeLeaf>(size.leaves);
        const std::span<LeafCorners> corners = engine.arena_.take<LeafCorners>(size.leaves);
        if (size.nodes != 0) {
            raise_tree(shapes[i], meshes[i]->triangles, nodes, leaves);
        }
        std::transform(leaves.begin(), leaves.end(), corners.begin(), corners_of);
        engine.trees_[i] = {nodes, leaves, reach_of(*meshes[i]), corners};
    }
    engine.take_lists(capacities);
    return engine;
}

std::optional<CpuEngine> CpuEngine::over_trees(std::span<const Tree> trees,
                                               const Capacities& capacities, LaneSet lanes) {
    if (!has_lane_set(lanes)) {
        return std::nullopt;
    }
    MemoryPlan memory_plan{Arena::size_bytes<Tree>(trees.size()), lists_bytes(capacities)};
    Arena arena(memory_plan.total_bytes());
    if (!arena.ok()) {
        return std::nullopt;
    }
    CpuEngine engine(std::move(arena), kernels_of(lanes));
    engine.memory_plan_ = memory_plan;
    engine.trees_ = engine.arena_.take<Tree>(trees.size());
    std::copy(trees.begin(), trees.end(), engine.trees_.begin());
    engine.take_lists(capacities);
    return engine;
}

/// Reserves the lists, the last part of the arena, and seals the arena.
void CpuEngine::take_lists(const Capacities& capacities) noexcept {
    lists_.nodes = arena_.take<NodePair>(capacities.node_pairs);
    lists_.keys = arena_.take<std::uint64_t>(kKeys);
    lists_.node_pairs = capacities.node_pairs;
    lists_.triangle_pairs = capacities.triangle_pairs;
    lists_.rechecks = pose_rechecks(capacities);
    arena_.seal();
}

void CpuEngine::run(std::span<const Query> queries, std::span<QueryResult> results) noexcept {
    AXG_ASSERT(queries.size() == results.size());
    if (!rounds_to_nearest()) {
        std::fill(results.begin(), results.end(), QueryResult{.status = QueryStatus::bad_rounding});
        return;
    }
    TraversalLists lists = lists_;
    lists.counts_all = false;
    for (std::size_t i = 0; i < queries.size(); ++i) {
        results[i] = QueryResult{};
        kernels_->run(trees_, lists, queries[i], results[i]);
    }
}

void CpuEngine::run(std::span<const Query> queries, std::span<QueryResult> results,
                    std::span<GroupWork> groups) noexcept {
    AXG_ASSERT(queries.size() == results.size());
    if (!rounds_to_nearest()) {
        std::fill(results.begin(), results.end(), QueryResult{.status = QueryStatus::bad_rounding});
        return;
    }
    TraversalLists lists = lists_;
    lists.node_pairs = lists.triangle_pairs = lists.rechecks = UINT32_MAX;
    for (std::size_t i = 0; i < queries.size(); ++i) {
        AXG_ASSERT(queries[i].group < groups.size());
        GroupWork& group = groups[queries[i].group];
        results[i] = QueryResult{.status = QueryStatus::ok};  // left out: near
        if (queries[i].kind == QueryKind::clearance) {
            results[i].status = QueryStatus::bad_query;  // its work depends on its results
        } else if (lists.counts_all || (!group.is_near && first_full(group) == QueryStatus::ok)) {
            lists.group = &group;
            results[i] = QueryResult{};
            if (i + 1 < queries.size()) {
                fetch_roots(trees_, queries[i], queries[i + 1]);
            }
            kernels_->run(trees_, lists, queries[i], results[i]);
            group.is_near = group.needs_all && results[i].proof != Proof::far;
        }
    }
    // The queries of a group have one share: if they overrun it, their earlier proofs are void.
    for (std::size_t i = 0; i < queries.size(); ++i) {
        const QueryStatus full = first_full(groups[queries[i].group]);
        if (full != QueryStatus::ok) {
            results[i] = QueryResult{.status = full};
        }
    }
}

Engine CpuEngine::engine() noexcept {
    return {.self = this,
            .run =
                [](void* self, std::span<const Query> queries,
                   std::span<QueryResult> results) noexcept {
                    static_cast<CpuEngine*>(self)->run(queries, results);
                },
            .prefers_batches = lists_.counts_all,
            .run_groups =
                [](void* self, std::span<const Query> queries, std::span<QueryResult> results,
                   std::span<GroupWork> groups) noexcept {
                    static_cast<CpuEngine*>(self)->run(queries, results, groups);
                }};
}

}  // namespace axg
