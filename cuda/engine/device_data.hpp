// SPDX-License-Identifier: Apache-2.0
// Contents of the device memory and of the pinned memory that host and device share. Plain data
// without CUDA types: the host lays it out, the kernels fill it. mm.
#pragma once

#include <cstdint>

#include "core/base/host_device.hpp"
#include "core/base/limits.hpp"
#include "core/collision/engine.hpp"
#include "core/collision/group_work.hpp"
#include "core/collision/query_tree.hpp"
#include "core/collision/tree.hpp"

namespace axg::cuda {

inline constexpr std::uint32_t kNoQuery = 0xffffffffU;
// Tree levels of pairs of nodes: each step opens at least one of two nodes, and both while both are
// inner nodes.
inline constexpr std::uint32_t kTreeLevelsMax = kTreeDepthMax + 1;
static_assert(kTreeLevelsMax <= kLevelsOfLoss);

/// One body's tree in the device's memory.
struct DeviceTree {
    const TreeNode* nodes = nullptr;
    const TreeLeaf* leaves = nullptr;
    std::uint32_t node_count = 0;
    float reach_mm = 0;
};

/// A pair of nodes to open. low_mm: a certified lower bound of the distance between their triangles
/// (clearance only).
struct alignas(16) PairEntry {
    std::uint32_t query, a, b;
    float low_mm;
};

/// Two triangles: nodes (leaves of their trees) and places in them.
struct alignas(16) TriangleEntry {
    std::uint32_t node_a, node_b;
    std::uint8_t place_a, place_b;
    std::uint16_t is_near;  // 1: certified within the margin, by float
    float low_mm;           // clearance: the certified lower bound in float
};

/// Whether a query's rechecks fit into the budget of its batch.
enum RecheckBudget : std::uint32_t { kBudgetUnknown = 0, kBudgetGiven = 1, kBudgetRefused = 2 };

/// Work and findings of one query so far. Zeroed by the first kernel of a batch.
struct Tally {
    std::uint32_t sequence;  // of the batch it was zeroed for
    std::uint32_t refused;   // 1: bad_query
    std::uint32_t near;      // farther; 1: settled as not proven, no recheck is needed
    std::uint32_t pairs_at[kTreeLevelsMax];        // pairs of nodes found, by tree level
    std::uint32_t triangle_pairs;                  // pairs of triangles left after clipping
    std::uint32_t rechecks, recheck_done;          // found, and handled
    std::uint32_t recheck_budget;                  // a RecheckBudget
    std::uint32_t touching, listed;                // not proven apart; of those listed by ids
    std::uint32_t candidates;                      // clearance: pairs of triangles that may set it
    std::uint32_t candidates_done[3];              // handled by each of the last three kernels
    std::uint32_t least_float;                     // bits of the least certified bound in float
    double bound_mm;                               // clearance: pairs at or beyond it are skipped
    unsigned long long least_first, least_second;  // bits of the least values in double
    unsigned long long nearest;                    // ids of the pair with that value
};

/// Work that all queries of a batch may use in total. The first level has one place for every query
/// in addition.
struct BatchBudget {
    std::uint32_t level_pairs, leaf_pairs, box_rows, triangle_pairs, rechecks;
};

/// Counters of one batch. If a kernel did not run, `handled` stays below `listed`.
struct Counters {
    std::uint32_t sequence, count, groups;
    BatchBudget budget;
    std::uint32_t listed[kTreeLevelsMax], handled[kTreeLevelsMax];  // pairs of nodes, by tree level
    std::uint32_t leaf_listed, leaf_handled;
    // Rows of boxes tested, pairs of triangles left after clipping: all queries together.
    std::uint32_t box_rows, triangle_pairs;
};

/// Each batch sums up one slice of the trees' memory and compares it with the sum after the upload:
/// one changed bit changes the sum of its slice.
inline constexpr std::uint32_t kSumBlocks = 32, kSumThreads = 64, kSumLoads = 8;
inline constexpr std::uint32_t kSliceWords = kSumBlocks * kSumThreads * kSumLoads;  // of 16 bytes

struct TreeSums {
    const std::uint32_t* words = nullptr;        // the trees, four words at a time
    const unsigned long long* wanted = nullptr;  // [slices]
    unsigned long long* found = nullptr;         // [2]: even and odd batches
    std::uint32_t slices = 0;
};

/// One share of a slice's sum. The factors are odd, so every single-bit change changes it.
AXG_HD unsigned long long sum_share(std::uint32_t place, const std::uint32_t (&w)[4]) noexcept {
    const unsigned long long factor = 0x9e3779b97f4a7c15ULL * (2ULL * place + 1);
    return factor * (w[0] + 0xbf58476d1ce4e5b9ULL * w[1]) +
           0x94d049bb133111ebULL * factor * (w[2] + 0xd6e8feb86659fd93ULL * w[3]);
}

inline constexpr std::uint32_t kNoLimit = 0xffffffffU;

/// Size of arrays with one entry per query: 512 of a stage and 2 of the known-answer test, rounded
/// up to whole warps.
inline constexpr std::uint32_t kBatchQueriesMax = 544;

/// A thread block poses kPartsOfBlock parts of boxes. Its first tree and its roots are contiguous,
/// so that the device can read them before it has read the counts. A root has two parts or more.
inline constexpr std::uint32_t kPartsOfBlock = 32, kRootsOfBlock = kPartsOfBlock / 2;
struct PartBlock {
    QueryTree tree;
    TreeRoot roots[kRootsOfBlock];
};
[[nodiscard]] AXG_HD constexpr std::uint32_t part_blocks(std::uint32_t queries) noexcept {
    return (queries + kPartsOfBlock - 1) / kPartsOfBlock;
}

/// Pinned, written by the host before a batch.
struct BatchHead {
    std::uint32_t sequence = 0, count = 0;
    std::uint32_t groups = 0;            // of a stage
    std::uint32_t parts = 0, depth = 0;  // the first `parts` queries are PartQueries of this depth
};

/// One result as the device writes it.
struct alignas(16) DeviceResult {
    std::uint32_t sequence, check;  // check: over all words below and the sequence
    std::uint32_t status, proof;
    std::uint32_t touching, node_pairs, triangle_pairs, rechecks;
    double clearance_mm;
    std::uint32_t nearest_a, nearest_b;
};
static_assert(sizeof(DeviceResult) == 48);

/// FNV-1a over words: detects a word that was not or only partly written.
template <unsigned kCount>
AXG_HD std::uint32_t hash_of(const std::uint32_t (&words)[kCount]) noexcept {
    std::uint32_t hash = 0x811c9dc5U;
    for (const std::uint32_t word : words) {
        hash = (hash ^ word) * 0x01000193U;
        hash ^= hash >> 15U;
    }
    return hash;
}

AXG_HD std::uint32_t check_of(const DeviceResult& a) noexcept {
    const std::uint64_t clearance = __builtin_bit_cast(std::uint64_t, a.clearance_mm);
    const std::uint32_t words[] = {a.sequence,
                                   a.status,
                                   a.proof,
                                   a.touching,
                                   a.node_pairs,
                                   a.triangle_pairs,
                                   a.rechecks,
                                   static_cast<std::uint32_t>(clearance),
                                   static_cast<std::uint32_t>(clearance >> 32U),
                                   a.nearest_a,
                                   a.nearest_b};
    return hash_of(words);
}

/// The work of one group of a stage as the device writes it.
struct alignas(16) DeviceGroupResult {
    std::uint32_t sequence, check;
    std::uint32_t lost, used[kWorkListCount];
};
static_assert(sizeof(DeviceGroupResult) == 32);

AXG_HD std::uint32_t check_of(const DeviceGroupResult& a) noexcept {
    const std::uint32_t words[] = {a.sequence, a.lost,    a.used[0], a.used[1],
                                   a.used[2],  a.used[3], a.used[4]};
    return hash_of(words);
}

/// Capacities: a query's own quotas, and the lists all queries of a batch share.
struct DeviceLimits {
    std::uint32_t queries = 0;                                       // of one batch
    std::uint32_t node_pairs = 0, triangle_pairs = 0, rechecks = 0;  // per query
    std::uint32_t candidates = 0;                                    // per query, clearance
    std::uint32_t level_pairs = 0, leaf_pairs = 0, box_rows = 0;     // per batch
    std::uint32_t batch_triangle_pairs = 0, batch_rechecks = 0;
    bool measures = false;          // a batch with a clearance query
    bool is_stage = false;          // queries in groups: the shares of the groups bound the work
    bool poses_parts = false;       // a stage in float that begins with parts of boxes
    bool has_rechecks = true;       // false: no query is tested in double
    std::uint32_t listed = 0;       // per query: touching pairs listed by ids, at most
    std::uint32_t tree_levels = 0;  // of pairs of nodes to open
    std::uint32_t meshes = 0;
};

struct PreparedQuery;

/// Every address a kernel may touch; a kernel's one parameter.
struct DeviceBuffers {
    DeviceLimits limits;
    // Pinned memory, by device addresses.
    const BatchHead* head = nullptr;
    const Query* queries = nullptr;
    const QueryTree* query_trees = nullptr;  // [kQueryTreesMax]
    const PartBlock* part_blocks = nullptr;  // [part_blocks(queries)]
    DeviceResult* results = nullptr;
    TriangleIds* listed = nullptr;            // [queries][listed], touching pairs
    const GroupSums* groups_in = nullptr;     // [queries]
    DeviceGroupResult* groups_out = nullptr;  // [queries]
    // Device memory.
    const DeviceTree* trees = nullptr;
    PreparedQuery* prepared = nullptr;
    Tally* tallies = nullptr;
    Counters* counters = nullptr;
    GroupSums* groups = nullptr;  // [queries]
    TreeSums sums;
    PairEntry* tree_level[2] = {nullptr, nullptr};
    PairEntry* leaves = nullptr;
    TriangleEntry* rechecks = nullptr;    // [queries][rechecks]
    TriangleEntry* candidates = nullptr;  // [queries][candidates]
    double* values = nullptr;             // [queries][candidates]
};

}  // namespace axg::cuda
