// SPDX-License-Identifier: Apache-2.0
// The data that host and device exchange in an offline batch. Plain data without CUDA types.
#pragma once

#include <cstdint>

#include "core/base/host_device.hpp"
#include "core/certificate/posed_queries.hpp"
#include "core/collision/engine.hpp"
#include "cuda/engine/device_data.hpp"

namespace axg::cuda {

/// A query with its pose. Each entry carries its batch: a copy that did not run is noticed.
struct alignas(16) GivenItem {
    Pose pose;
    double r_mm, pose_error_mm;
    std::uint32_t mesh_a, mesh_b;
    std::uint32_t is_float_only, sequence;
};
static_assert(sizeof(GivenItem) == 128);

/// A query without. row: of the batch's positions, which follow the items in the same copy.
struct alignas(16) PosedItem {
    std::uint32_t pair, row;
    double r_mm, pose_error_mm;
    std::uint32_t is_float_only, sequence;
};
static_assert(sizeof(PosedItem) == 32);

/// Zeroed memory is none of these.
enum OfflineState : std::uint32_t {
    kOfflineFar = 1,
    kOfflineNear,
    kOfflineAgain,    // a list is full or a capacity exceeded: the CPU engine answers
    kOfflineRefused,  // bad_query
    kOfflineStates
};

struct alignas(16) OfflineAnswer {
    std::uint32_t sequence, check;  // check: over all words below, the sequence and the place
    std::uint32_t state;
    std::uint32_t node_pairs, triangle_pairs, rechecks;
    std::uint32_t unused[2];
};
static_assert(sizeof(OfflineAnswer) == 32);

/// @param place  of the query in its batch
AXG_HD std::uint32_t check_of(const OfflineAnswer& a, std::uint32_t place) noexcept {
    const std::uint32_t words[] = {a.sequence,       a.state,    place,     a.node_pairs,
                                   a.triangle_pairs, a.rechecks, 0x0ff11e5U};
    return hash_of(words);
}

/// Each batch sums up all of the trees' memory, in slices of 32 KiB, and the host compares.
inline constexpr std::uint32_t kOfflineThreads = 128, kOfflineSumLoads = 16;
inline constexpr std::uint32_t kOfflineSliceWords = kOfflineThreads * kOfflineSumLoads;
struct alignas(16) OfflineSum {
    std::uint32_t sequence, slice;
    unsigned long long sum;
};

/// One warp answers one query.
inline constexpr std::uint32_t kQueriesOfBlock = kOfflineThreads / 32;

struct OfflinePrepared;

/// Every address of one batch.
struct OfflineBuffers {
    std::uint32_t sequence = 0, count = 0;
    std::uint32_t rows = 0, axes = 0, pairs = 0, chains = 0, meshes = 0;
    std::uint32_t node_pairs = 0, triangle_pairs = 0, rechecks = 0;  // capacities of a query
    const DeviceTree* trees = nullptr;
    const std::uint32_t* tree_words = nullptr;
    std::uint32_t slices = 0;
    const ChainJoint* joints = nullptr;
    const PlacedChain* placed = nullptr;
    const PosedPair* posed_pairs = nullptr;
    const GivenItem* given = nullptr;  // of the batch, or null
    const PosedItem* posed = nullptr;
    const double* positions = nullptr;
    OfflinePrepared* prepared = nullptr;  // [count]
    OfflineSum* sums = nullptr;           // [slices]
    OfflineAnswer* answers = nullptr;     // [count]
};

}  // namespace axg::cuda
