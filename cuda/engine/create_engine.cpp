// SPDX-License-Identifier: Apache-2.0
// Everything the CUDA engine does before its first query: trees, memory, graphs, warm-up.
#include <algorithm>
#include <cstring>
#include <utility>

#include "core/collision/tree.hpp"
#include "cuda/engine/engine_parts.hpp"
#include "cuda/engine/memory_block.hpp"

namespace axg {
namespace {

using namespace cuda;

constexpr std::uint32_t kWarmUpUs = 10'000'000;

struct Trees {
    const TreeBodies& bodies;
    std::vector<DeviceTree> placed;
    std::size_t bytes = 0;
};

void place_trees(Trees& trees, DeviceBuffers& b, MemoryBlock& block) {
    const std::vector<TreeData>& built = trees.bodies.trees;
    b.trees = block.take<DeviceTree>(built.size());
    for (std::size_t i = 0; i < built.size(); ++i) {
        DeviceTree& tree = trees.placed[i];
        tree.nodes = block.take<TreeNode>(built[i].nodes.size());
        tree.leaves = block.take<TreeLeaf>(built[i].leaves.size());
    }
    // Round up to whole slices: their sums then need no special case at the end.
    constexpr std::size_t kSliceBytes = std::size_t{kSliceWords} * 16;
    b.sums.slices = static_cast<std::uint32_t>((block.used() + kSliceBytes - 1) / kSliceBytes);
    trees.bytes = b.sums.slices * kSliceBytes;
    block.take<std::byte>(trees.bytes - block.used());
}

/// Each list has the larger of the two lengths that proofs and clearances need.
void place_lists(DeviceBuffers& b, const DeviceLimits& other, MemoryBlock& block) {
    const DeviceLimits& limits = b.limits;
    const std::size_t queries = limits.queries;
    b.prepared = reinterpret_cast<PreparedQuery*>(
        block.take<std::byte>(queries * prepared_query_size_bytes()));
    b.tallies = block.take<Tally>(queries);
    b.counters = block.take<Counters>(1);
    b.groups = block.take<GroupSums>(queries);
    b.sums.wanted = block.take<unsigned long long>(b.sums.slices);
    b.sums.found = block.take<unsigned long long>(2);
    const std::uint32_t level_pairs = std::max(limits.level_pairs, other.level_pairs);
    b.tree_level[0] = block.take<PairEntry>(level_pairs);
    b.tree_level[1] = block.take<PairEntry>(level_pairs);
    b.leaves = block.take<PairEntry>(std::max(limits.leaf_pairs, other.leaf_pairs));
    b.rechecks = block.take<TriangleEntry>(queries * limits.rechecks);
    b.candidates = block.take<TriangleEntry>(queries * limits.candidates);
    b.values = block.take<double>(queries * limits.candidates);
}

/// Pinned memory: `parts` stores the host addresses, `parts.buffers` the device addresses.
void place_pinned(CudaEngine::Parts& parts, MemoryBlock& host, MemoryBlock& device) {
    const DeviceLimits& limits = parts.buffers.limits;
    parts.head = host.take<BatchHead>(1);
    parts.queries = host.take<Query>(limits.queries);
    parts.query_trees = host.take<QueryTree>(kQueryTreesMax);
    parts.part_blocks = host.take<PartBlock>(part_blocks(limits.queries));
    parts.results = host.take<DeviceResult>(limits.queries);
    parts.listed = host.take<TriangleIds>(std::size_t{limits.queries} * limits.listed);
    parts.groups_in = host.take<GroupSums>(limits.queries);
    parts.groups_out = host.take<DeviceGroupResult>(limits.queries);
    parts.buffers.head = device.take<BatchHead>(1);
    parts.buffers.queries = device.take<Query>(limits.queries);
    parts.buffers.query_trees = device.take<QueryTree>(kQueryTreesMax);
    parts.buffers.part_blocks = device.take<PartBlock>(part_blocks(limits.queries));
    parts.buffers.results = device.take<DeviceResult>(limits.queries);
    parts.buffers.listed = device.take<TriangleIds>(std::size_t{limits.queries} * limits.listed);
    parts.buffers.groups_in = device.take<GroupSums>(limits.queries);
    parts.buffers.groups_out = device.take<DeviceGroupResult>(limits.queries);
}

/// A batch of proofs and counts.
DeviceLimits limits_of(const Capacities& capacities, const CudaOptions& options,
                       const TreeBodies& bodies) {
    DeviceLimits limits;
    limits.queries = std::clamp(options.queries_max, 1U, kBatchQueriesMax);
    limits.node_pairs = capacities.node_pairs;
    limits.triangle_pairs = capacities.triangle_pairs;
    limits.rechecks = pose_rechecks(capacities);
    limits.candidates = options.candidates;
    const BatchCapacities& batch = capacities.batch;
    limits.level_pairs = std::max(batch.level_pairs, limits.queries);  // holds all roots
    limits.leaf_pairs = batch.leaf_pairs;
    limits.box_rows = batch.box_rows;
    limits.batch_triangle_pairs = batch.triangle_pairs;
    limits.batch_rechecks = batch.rechecks;
    limits.listed = options.listed;
    limits.meshes = static_cast<std::uint32_t>(bodies.trees.size());
    limits.tree_levels = bodies.tree_levels;
    return limits;
}

/// A batch with a clearance query: its own lists, and no limit on the total work of the batch.
DeviceLimits clearance_limits_of(DeviceLimits limits, const CudaOptions& options) {
    limits.level_pairs = std::max(options.level_pairs, limits.queries);
    limits.leaf_pairs = options.leaf_pairs;
    limits.box_rows = limits.batch_triangle_pairs = limits.batch_rechecks = kNoLimit;
    limits.measures = true;
    return limits;
}

/// A batch of queries in groups: the shares bound its node and triangle pairs, not capacities. Its
/// lists are those of a clearance, far longer than the sum of the shares of a plan.
DeviceLimits stage_limits_of(DeviceLimits limits, const DeviceLimits& clearance) {
    limits.level_pairs = clearance.level_pairs;
    limits.leaf_pairs = clearance.leaf_pairs;
    limits.box_rows = limits.batch_triangle_pairs = limits.batch_rechecks = kNoLimit;
    limits.node_pairs = limits.triangle_pairs = kNoLimit;
    limits.is_stage = true;
    return limits;
}

bool failed(cudaError_t error, const char* what, std::string& fault) {
    if (error == cudaSuccess) {
        return false;
    }
    fault = std::string(what) + ": " + cudaGetErrorString(error);
    return true;
}

/// Trees, lists and pinned memory: one block on the device and one on the host, and no later ones.
bool reserve(CudaEngine::Parts& parts, Trees& trees, std::string& fault) {
    MemoryBlock count(nullptr), pinned_count(nullptr), none(nullptr);
    place_trees(trees, parts.buffers, count);
    parts.memory_plan.trees_bytes = trees.bytes;
    place_lists(parts.buffers, parts.clearance_limits, count);
    parts.memory_plan.lists_bytes = count.used() - parts.memory_plan.trees_bytes;
    place_pinned(parts, pinned_count, none);
    parts.memory_plan.pinned_bytes = pinned_count.used();
    void *device = nullptr, *pinned = nullptr, *mapped = nullptr;
    if (failed(cudaMalloc(&device, parts.memory_plan.device_bytes()), "device memory", fault) ||
        failed(cudaHostAlloc(&pinned, parts.memory_plan.pinned_bytes, cudaHostAllocMapped),
               "pinned memory", fault) ||
        failed(cudaHostGetDevicePointer(&mapped, pinned, 0), "mapped memory", fault) ||
        failed(cudaMemset(device, 0, parts.memory_plan.device_bytes()), "device memory", fault)) {
        return false;
    }
    parts.device_memory = static_cast<std::byte*>(device);
    parts.pinned_memory = static_cast<std::byte*>(pinned);
    std::memset(pinned, 0, parts.memory_plan.pinned_bytes);
    MemoryBlock device_block(parts.device_memory), host_block(parts.pinned_memory),
        mapped_block(static_cast<std::byte*>(mapped));
    place_trees(trees, parts.buffers, device_block);
    place_lists(parts.buffers, parts.clearance_limits, device_block);
    place_pinned(parts, host_block, mapped_block);
    for (std::size_t i = 0; i < trees.placed.size(); ++i) {
        DeviceTree& to = trees.placed[i];
        const TreeData& from = trees.bodies.trees[i];
        to.node_count = static_cast<std::uint32_t>(from.nodes.size());
        to.reach_mm = trees.bodies.reach_mm[i];
        if (failed(cudaMemcpy(const_cast<TreeNode*>(to.nodes), from.nodes.data(),
                              from.nodes.size() * sizeof(TreeNode), cudaMemcpyHostToDevice),
                   "nodes", fault) ||
            failed(cudaMemcpy(const_cast<TreeLeaf*>(to.leaves), from.leaves.data(),
                              from.leaves.size() * sizeof(TreeLeaf), cudaMemcpyHostToDevice),
                   "leaves", fault)) {
            return false;
        }
    }
    return !failed(cudaMemcpy(const_cast<DeviceTree*>(parts.buffers.trees), trees.placed.data(),
                              trees.placed.size() * sizeof(DeviceTree), cudaMemcpyHostToDevice),
                   "trees", fault);
}

/// Reads the trees back and sums them up. This also checks the upload.
bool sum_trees(CudaEngine::Parts& parts, const Trees& trees, std::string& fault) {
    parts.buffers.sums.words = reinterpret_cast<const std::uint32_t*>(parts.device_memory);
    std::vector<std::uint32_t> words(trees.bytes / sizeof(std::uint32_t));
    if (failed(cudaMemcpy(words.data(), parts.device_memory, trees.bytes, cudaMemcpyDeviceToHost),
               "reading the trees back", fault)) {
        return false;
    }
    std::vector<unsigned long long> sums(parts.buffers.sums.slices, 0);
    for (std::size_t i = 0; i < words.size() / 4; ++i) {
        const std::uint32_t share[4] = {words[4 * i], words[4 * i + 1], words[4 * i + 2],
                                        words[4 * i + 3]};
        sums[i / kSliceWords] += sum_share(static_cast<std::uint32_t>(i % kSliceWords), share);
    }
    return !failed(cudaMemcpy(const_cast<unsigned long long*>(parts.buffers.sums.wanted),
                              sums.data(), sums.size() * sizeof(sums[0]), cudaMemcpyHostToDevice),
                   "sums of the trees", fault);
}

cudaError_t launch_batch(const DeviceBuffers& b, const Launch& launch, LaunchLeaves leaves) {
    const bool measures = b.limits.measures;
    cudaError_t error =
        b.limits.poses_parts ? launch_prepare_parts(b, launch) : launch_prepare_queries(b, launch);
    const auto next = [&error](cudaError_t status) {
        error = error != cudaSuccess ? error : status;
    };
    if (measures) {
        next(launch_seed_upper_bounds(b, launch));
    }
    for (std::uint32_t tree_level = 0; tree_level < b.limits.tree_levels; ++tree_level) {
        next(launch_open_pairs(b, launch, tree_level));
    }
    next(leaves != nullptr ? static_cast<cudaError_t>(leaves(b, launch))
                           : launch_test_leaves(b, launch));
    if (measures) {
        next(launch_measure_leaves(b, launch));
    }
    if (b.limits.has_rechecks) {
        next(launch_recheck_pairs(b, launch));
    }
    if (measures) {
        next(launch_refine_distances(b, launch, 0));
        next(launch_refine_distances(b, launch, 1));
        next(launch_pick_nearest(b, launch));
    }
    next(launch_write_results(b, launch));
    return error;
}

bool record(const CudaEngine::Parts& parts, const DeviceLimits& limits, LaunchLeaves leaves,
            BatchGraph& out, std::string& fault) {
    int capability = 0;
    if (failed(cudaDeviceGetAttribute(&capability, cudaDevAttrComputeCapabilityMajor, 0),
               "compute capability", fault)) {
        return false;
    }
    const Launch launch{parts.partition.stream, parts.partition.multiprocessors,
                        capability >= kOverlapsSince};
    if (failed(cudaStreamBeginCapture(launch.stream, cudaStreamCaptureModeThreadLocal),
               "recording the batch", fault)) {
        return false;
    }
    DeviceBuffers buffers = parts.buffers;
    buffers.limits = limits;
    const cudaError_t launched = launch_batch(buffers, launch, leaves);
    return !failed(cudaStreamEndCapture(launch.stream, &out.graph), "recording the batch", fault) &&
           !failed(launched, "recording the batch", fault) &&
           !failed(cudaGraphInstantiate(&out.exec, out.graph, 0), "the batch's graph", fault) &&
           !failed(cudaGraphUpload(out.exec, launch.stream), "uploading the graph", fault) &&
           !failed(cudaStreamSynchronize(launch.stream), "uploading the graph", fault);
}

/// One batch of each kind.
void warm_up(CudaEngine& engine) {
    Query query;
    query.r_mm = 1;
    query.pose.t[0] = 1e3;
    QueryResult result;
    engine.run({&query, 1}, {&result, 1});
    GroupWork group{.share = kKnownAnswerShare};
    engine.run({&query, 1}, {&result, 1}, {&group, 1});
    query.is_float_only = true;
    engine.run({&query, 1}, {&result, 1}, {&group, 1});
    QueryTree tree;
    tree.is_float_only = true;  // required: no kernel of that graph tests in double
    const TreeRoot root;
    QueryResult both[2];
    if (engine.parts_max() >= std::size(both)) {
        engine.run(PartQueries{{&tree, 1}, {&root, 1}}, {}, both, {&group, 1});
    }
    query.is_float_only = false;
    query.kind = QueryKind::clearance;
    engine.run({&query, 1}, {&result, 1});
}

}  // namespace

TreeBodies cuda::tree_bodies_of(std::span<const Mesh* const> meshes) {
    TreeBodies bodies;
    for (const Mesh* mesh : meshes) {
        const bool is_usable = has_usable_triangles(*mesh);
        bodies.trees.push_back(is_usable ? build_tree(*mesh) : TreeData{});
        bodies.reach_mm.push_back(reach_of(*mesh));
        // A tree of one leaf also needs one level: the first opening lists it as a leaf.
        bodies.tree_levels =
            std::max(bodies.tree_levels, bodies.trees.back().depth - (is_usable ? 1U : 0U));
    }
    return bodies;
}

std::optional<CudaEngine> CudaEngine::create(std::span<const Mesh* const> meshes,
                                             const Capacities& capacities,
                                             const CudaOptions& options, std::string& fault) {
    CudaDevice device;  // opened first: building trees is slow and useless without a device
    if (!cuda::open_device(device, fault)) {
        return std::nullopt;
    }
    return Parts::engine_over(tree_bodies_of(meshes), capacities, options, fault);
}

std::optional<CudaEngine> CudaEngine::Parts::engine_over(const TreeBodies& bodies,
                                                         const Capacities& capacities,
                                                         const CudaOptions& options,
                                                         std::string& fault) {
    auto parts = std::make_unique<Parts>();
    if (!open_device(parts->device, fault) ||
        !make_partition(options.multiprocessors, parts->partition, fault)) {
        return std::nullopt;
    }
    parts->device.multiprocessors_used = parts->partition.multiprocessors;
    parts->deadline_us = options.deadline_us;
    Trees trees{bodies, std::vector<DeviceTree>(bodies.trees.size())};
    parts->buffers.limits = limits_of(capacities, options, bodies);
    parts->clearance_limits = clearance_limits_of(parts->buffers.limits, options);
    parts->stage_limits = stage_limits_of(parts->buffers.limits, parts->clearance_limits);
    parts->float_stage_limits = parts->stage_limits;
    parts->float_stage_limits.has_rechecks = false;
    parts->part_limits = parts->float_stage_limits;
    parts->part_limits.poses_parts = true;
    parts->groups_here.reserve(parts->buffers.limits.queries);
    parts->place_of_group.assign(kGroupsMax, kNoGroup);
    if (!reserve(*parts, trees, fault) || !sum_trees(*parts, trees, fault) ||
        // Copies and memsets ran on another stream than the batches will.
        failed(cudaDeviceSynchronize(), "filling the memory", fault) ||
        !record(*parts, parts->buffers.limits, options.launch_leaves, parts->proofs, fault) ||
        !record(*parts, parts->clearance_limits, options.launch_leaves, parts->clearances, fault) ||
        !record(*parts, parts->stage_limits, options.launch_leaves, parts->stages, fault) ||
        !record(*parts, parts->float_stage_limits, options.launch_leaves, parts->float_stages,
                fault) ||
        !record(*parts, parts->part_limits, options.launch_leaves, parts->part_stages, fault)) {
        return std::nullopt;
    }
    // The first launch of a kernel loads it: every kernel runs once before the first cycle.
    // Loading may exceed the deadline of a batch, so the warm-up has a longer one.
    CudaEngine engine(std::move(parts));
    engine.parts_->deadline_us = std::max(options.deadline_us, kWarmUpUs);
    warm_up(engine);
    engine.parts_->deadline_us = options.deadline_us;
    if (engine.fault() != nullptr) {
        fault = std::string("the warm-up batch failed: ") + engine.fault();
        return std::nullopt;
    }
    return engine;
}

}  // namespace axg
