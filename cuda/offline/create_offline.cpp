// SPDX-License-Identifier: Apache-2.0
// Everything the offline engine does before its first query: trees, memory, a warm-up batch.
#include <algorithm>
#include <cstring>
#include <utility>

#include "core/collision/tree.hpp"
#include "cuda/engine/engine_parts.hpp"
#include "cuda/engine/memory_block.hpp"
#include "cuda/offline/offline_kernels.hpp"
#include "cuda/offline/offline_parts.hpp"

namespace axg {
namespace {

using namespace cuda;
using Parts = OfflineEngine::Parts;

constexpr std::size_t kSliceBytes = std::size_t{kOfflineSliceWords} * 16;

bool offline_failed(cudaError_t error, const char* what, std::string& fault) {
    if (error == cudaSuccess) {
        return false;
    }
    fault = std::string(what) + ": " + cudaGetErrorString(error);
    return true;
}

/// The device memory that no batch changes: the trees first, in whole slices.
struct Content {
    DeviceTree* trees = nullptr;
    std::vector<TreeNode*> nodes;
    std::vector<TreeLeaf*> leaves;
    std::size_t tree_bytes = 0;
    ChainJoint* joints = nullptr;
    PlacedChain* chains = nullptr;
    PosedPair* pairs = nullptr;
};

Content place_content(const TreeBodies& bodies, const Parts& parts, MemoryBlock& block) {
    Content out;
    out.trees = block.take<DeviceTree>(bodies.trees.size());
    for (const TreeData& tree : bodies.trees) {
        out.nodes.push_back(block.take<TreeNode>(tree.nodes.size()));
        out.leaves.push_back(block.take<TreeLeaf>(tree.leaves.size()));
    }
    out.tree_bytes = (block.used() + kSliceBytes - 1) / kSliceBytes * kSliceBytes;
    block.take<std::byte>(out.tree_bytes - block.used());
    out.joints = block.take<ChainJoint>(parts.chains.joints.size());
    out.chains = block.take<PlacedChain>(parts.chains.chains.size());
    out.pairs = block.take<PosedPair>(parts.pairs.size());
    return out;
}

/// Memory of all slots. `device` and `pinned` count where they have no block.
void place_slots(Parts& parts, const OfflineBuffers& common, MemoryBlock& device,
                 MemoryBlock& pinned) {
    const std::size_t queries = parts.options.queries_max;
    // Posed: as many rows as queries, one a query at most.
    const std::size_t posed = sizeof(PosedItem) + parts.chains.axes * sizeof(double);
    parts.items_bytes = queries * std::max(sizeof(GivenItem), posed);
    const std::size_t answers =
        common.slices * sizeof(OfflineSum) + queries * sizeof(OfflineAnswer);
    for (OfflineSlot& slot : parts.slots) {
        slot.items_device = device.take<std::byte>(parts.items_bytes);
        slot.answers_device = device.take<std::byte>(answers);
        slot.buffers = common;
        slot.buffers.prepared = reinterpret_cast<OfflinePrepared*>(
            device.take<std::byte>(queries * offline_prepared_size_bytes()));
        slot.buffers.sums = reinterpret_cast<OfflineSum*>(slot.answers_device);
        slot.buffers.answers = reinterpret_cast<OfflineAnswer*>(slot.answers_device +
                                                                common.slices * sizeof(OfflineSum));
        slot.items = pinned.take<std::byte>(parts.items_bytes);
        slot.answers = pinned.take<std::byte>(answers);
    }
}

template <class T>
bool upload(T* to, const T* from, std::size_t count, std::string& fault) {
    return count == 0 ||
           !offline_failed(cudaMemcpy(to, from, count * sizeof(T), cudaMemcpyHostToDevice),
                           "copying to the GPU", fault);
}

bool upload_all(const TreeBodies& bodies, const Parts& parts, const Content& to,
                std::string& fault) {
    std::vector<DeviceTree> trees(bodies.trees.size());
    for (std::size_t i = 0; i < trees.size(); ++i) {
        const TreeData& from = bodies.trees[i];
        trees[i] = {to.nodes[i], to.leaves[i], static_cast<std::uint32_t>(from.nodes.size()),
                    bodies.reach_mm[i]};
        if (!upload(to.nodes[i], from.nodes.data(), from.nodes.size(), fault) ||
            !upload(to.leaves[i], from.leaves.data(), from.leaves.size(), fault)) {
            return false;
        }
    }
    const MachineChains& chains = parts.chains;
    return upload(to.trees, trees.data(), trees.size(), fault) &&
           upload(to.joints, chains.joints.data(), chains.joints.size(), fault) &&
           upload(to.chains, chains.chains.data(), chains.chains.size(), fault) &&
           upload(to.pairs, parts.pairs.data(), parts.pairs.size(), fault);
}

/// Reads the trees back and sums them up; this also checks the upload.
bool sum_offline_trees(Parts& parts, const TreeBodies& bodies, const Content& at,
                       std::string& fault) {
    std::vector<std::byte> bytes(at.tree_bytes);
    if (offline_failed(
            cudaMemcpy(bytes.data(), parts.device_memory, bytes.size(), cudaMemcpyDeviceToHost),
            "reading the trees back", fault)) {
        return false;
    }
    for (std::size_t i = 0; i < bodies.trees.size(); ++i) {
        const TreeData& tree = bodies.trees[i];
        const auto place = [&](const void* of) {
            return static_cast<std::size_t>(static_cast<const std::byte*>(of) -
                                            parts.device_memory);
        };
        if ((!tree.nodes.empty() &&
             std::memcmp(bytes.data() + place(at.nodes[i]), tree.nodes.data(),
                         tree.nodes.size() * sizeof(TreeNode)) != 0) ||
            (!tree.leaves.empty() &&
             std::memcmp(bytes.data() + place(at.leaves[i]), tree.leaves.data(),
                         tree.leaves.size() * sizeof(TreeLeaf)) != 0)) {
            fault = "the trees came back from the GPU changed";
            return false;
        }
    }
    parts.wanted.assign(at.tree_bytes / kSliceBytes, 0);
    for (std::size_t i = 0; i < at.tree_bytes / 16; ++i) {
        std::uint32_t words[4];
        std::memcpy(words, bytes.data() + 16 * i, sizeof words);
        parts.wanted[i / kOfflineSliceWords] +=
            sum_share(static_cast<std::uint32_t>(i % kOfflineSliceWords), words);
    }
    return true;
}

bool reserve_offline(Parts& parts, const TreeBodies& bodies, const Capacities& capacities,
                     std::string& fault) {
    OfflineBuffers common;
    common.axes = parts.chains.axes;
    common.pairs = static_cast<std::uint32_t>(parts.pairs.size());
    common.chains = static_cast<std::uint32_t>(parts.chains.chains.size());
    common.meshes = static_cast<std::uint32_t>(bodies.trees.size());
    common.node_pairs = capacities.node_pairs;
    common.triangle_pairs = capacities.triangle_pairs;
    common.rechecks = pose_rechecks(capacities);
    MemoryBlock count(nullptr), pinned_count(nullptr);
    const Content planned = place_content(bodies, parts, count);
    common.slices = static_cast<std::uint32_t>(planned.tree_bytes / kSliceBytes);
    parts.memory_plan.trees_bytes = count.used();
    place_slots(parts, common, count, pinned_count);
    parts.memory_plan.lists_bytes = count.used() - parts.memory_plan.trees_bytes;
    parts.memory_plan.pinned_bytes = pinned_count.used();
    void *device = nullptr, *pinned = nullptr;
    if (offline_failed(cudaMalloc(&device, count.used()), "device memory", fault)) {
        return false;
    }
    parts.device_memory = static_cast<std::byte*>(device);
    if (offline_failed(cudaHostAlloc(&pinned, pinned_count.used(), cudaHostAllocDefault),
                       "pinned memory", fault)) {
        return false;
    }
    parts.pinned_memory = static_cast<std::byte*>(pinned);
    std::memset(pinned, 0, pinned_count.used());
    if (offline_failed(cudaMemset(device, 0, count.used()), "device memory", fault)) {
        return false;
    }
    MemoryBlock device_block(parts.device_memory), pinned_block(parts.pinned_memory);
    const Content content = place_content(bodies, parts, device_block);
    common.trees = content.trees;
    common.tree_words = reinterpret_cast<const std::uint32_t*>(parts.device_memory);
    common.joints = content.joints;
    common.placed = content.chains;
    common.posed_pairs = content.pairs;
    place_slots(parts, common, device_block, pinned_block);
    return upload_all(bodies, parts, content, fault) &&
           sum_offline_trees(parts, bodies, content, fault) &&
           !offline_failed(cudaDeviceSynchronize(), "filling the memory", fault);
}

bool open_slots(Parts& parts, std::string& fault) {
    for (OfflineSlot& slot : parts.slots) {
        if (offline_failed(cudaStreamCreateWithFlags(&slot.stream, cudaStreamNonBlocking),
                           "a stream", fault)) {
            return false;
        }
        const unsigned flags = parts.options.measures ? cudaEventDefault : cudaEventDisableTiming;
        for (cudaEvent_t* const mark :
             {&slot.done, &slot.marks[0], &slot.marks[1], &slot.marks[2], &slot.marks[3]}) {
            if (offline_failed(cudaEventCreateWithFlags(mark, flags), "an event", fault)) {
                return false;
            }
        }
    }
    return true;
}

bool are_in_range(const Parts& parts, std::size_t meshes) {
    const std::size_t chains = parts.chains.chains.size();
    return std::all_of(parts.pairs.begin(), parts.pairs.end(), [&](const PosedPair& pair) {
        return pair.chain_a < chains && pair.chain_b < chains && pair.mesh_a < meshes &&
               pair.mesh_b < meshes;
    });
}

}  // namespace

std::optional<OfflineEngine> OfflineEngine::create(
    std::span<const Mesh* const> meshes, const Capacities& capacities, const MachineChains& chains,
    std::span<const PosedPair> pairs, const OfflineOptions& options, std::string& fault) {
    auto parts = std::make_unique<Parts>();
    if (!open_device(parts->device, fault)) {
        return std::nullopt;
    }
    parts->device.multiprocessors_used = parts->device.multiprocessors;
    parts->options = options;
    parts->options.queries_max = std::clamp(options.queries_max, 1U, kOfflineQueriesMax);
    parts->chains = chains;
    parts->pairs.assign(pairs.begin(), pairs.end());
    parts->slots.resize(std::clamp(options.batches, 1U, 8U));
    parts->again.reserve(parts->options.queries_max);
    for (OfflineSlot& slot : parts->slots) {
        slot.others.reserve(parts->options.queries_max);
    }
    if (!are_in_range(*parts, meshes.size())) {
        fault = "a pair of the offline engine names a body or surface that is not there";
        return std::nullopt;
    }
    std::optional<CpuEngine> cpu = CpuEngine::create(meshes, capacities);
    if (!cpu) {
        fault = std::string(kNoLaneSet);
        return std::nullopt;
    }
    parts->cpu = std::make_unique<CpuEngine>(std::move(*cpu));
    if (!reserve_offline(*parts, tree_bodies_of(meshes), capacities, fault) ||
        !open_slots(*parts, fault)) {
        return std::nullopt;
    }
    OfflineEngine engine(std::move(parts));
    const Query query;
    QueryResult result;
    engine.run({&query, 1}, {&result, 1});  // the first launch of a kernel loads it
    if (engine.fault() != nullptr) {
        fault = std::string("the warm-up batch failed: ") + engine.fault();
        return std::nullopt;
    }
    engine.parts_->work = {};
    return engine;
}

}  // namespace axg
