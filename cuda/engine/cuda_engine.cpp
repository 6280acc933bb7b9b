// SPDX-License-Identifier: Apache-2.0
// The host's side of a batch: writes queries to pinned memory, launches once, polls results until
// the deadline. No function here allocates or waits without a limit, except the destructor.
#include "cuda/engine/cuda_engine.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstring>
#include <utility>

#include "core/base/assert.hpp"
#include "core/base/rounding_mode.hpp"
#include "cuda/engine/engine_parts.hpp"

namespace axg {
namespace {

using namespace cuda;
using Clock = std::chrono::steady_clock;

constexpr std::size_t kAhead = 12;  // results to prefetch ahead
constexpr int kPoison = 0xa5;       // fills results before a batch: an unwritten one is not valid

/// Reads one result from pinned memory. False if it has not arrived or is incomplete.
bool read_result(DeviceResult& from, std::uint32_t sequence, QueryResult& to) noexcept {
    if (std::atomic_ref<std::uint32_t>(from.sequence).load(std::memory_order_acquire) != sequence) {
        return false;
    }
    const DeviceResult copy = from;
    std::atomic_signal_fence(std::memory_order_seq_cst);  // read again each time
    if (copy.sequence != sequence || copy.check != check_of(copy) ||
        copy.status > static_cast<std::uint32_t>(QueryStatus::too_many_box_rows) ||
        copy.proof > 1) {
        return false;
    }
    to.status = static_cast<QueryStatus>(copy.status);
    to.proof = static_cast<Proof>(copy.proof);
    to.touching = copy.touching;
    to.clearance_mm = copy.clearance_mm;
    to.nearest = {copy.nearest_a, copy.nearest_b};
    to.node_pairs = copy.node_pairs;
    to.triangle_pairs = copy.triangle_pairs;
    to.rechecks = copy.rechecks;
    return true;
}

/// Reads the work of one group of a stage in the same way.
bool read_result(DeviceGroupResult& from, std::uint32_t sequence, GroupWork& to) noexcept {
    if (std::atomic_ref<std::uint32_t>(from.sequence).load(std::memory_order_acquire) != sequence) {
        return false;
    }
    const DeviceGroupResult copy = from;
    std::atomic_signal_fence(std::memory_order_seq_cst);
    if (copy.sequence != sequence || copy.check != check_of(copy)) {
        return false;
    }
    take_sums(copy.used, copy.lost, to);
    return true;
}

/// Polls one result. False: it was late or incomplete at the deadline.
template <class From, class To>
bool wait_for(From& from, std::uint32_t sequence, Clock::time_point deadline, To& to) noexcept {
    for (;;) {
        for (int spin = 0; spin < 64; ++spin) {
            if (read_result(from, sequence, to)) {
                return true;
            }
        }
        if (Clock::now() > deadline) {
            return read_result(from, sequence, to);
        }
    }
}

/// Numbers the groups that occur in a launch, in order of first use.
class GroupPlaces {
  public:
    GroupPlaces(CudaEngine::Parts& parts, std::span<const GroupWork> groups) noexcept
        : parts_(parts), groups_(groups) {
        parts_.groups_here.clear();
    }
    GroupPlaces(const GroupPlaces&) = delete;
    GroupPlaces& operator=(const GroupPlaces&) = delete;
    ~GroupPlaces() {
        for (const std::uint16_t group : parts_.groups_here) {
            parts_.place_of_group[group] = kNoGroup;
        }
    }
    [[nodiscard]] std::uint16_t of(std::uint16_t group) noexcept {
        if (groups_.empty()) {
            return group;
        }
        AXG_ASSERT(group < groups_.size());
        std::uint16_t& place = parts_.place_of_group[group];
        if (place == kNoGroup) {
            place = static_cast<std::uint16_t>(parts_.groups_here.size());
            parts_.groups_in[place] = sums_of(groups_[group], parts_.sequence);
            parts_.groups_here.push_back(group);
        }
        return place;
    }

  private:
    CudaEngine::Parts& parts_;
    std::span<const GroupWork> groups_;
};

/// Gives each block of parts the roots of its parts and the tree of the first root.
void place_parts(CudaEngine::Parts& parts, const PartQueries& asked, GroupPlaces& places) noexcept {
    for (std::uint32_t i = 0; i < asked.roots.size(); ++i) {
        TreeRoot root = asked.roots[i];
        root.group = places.of(root.group);
        const std::uint32_t first = i << asked.depth, last = first + (1U << asked.depth) - 1;
        for (std::uint32_t b = first / kPartsOfBlock; b <= last / kPartsOfBlock; ++b) {
            PartBlock& block = parts.part_blocks[b];
            const std::uint32_t place = i - (b * kPartsOfBlock >> asked.depth);
            block.roots[place] = root;
            if (place == 0) {
                block.tree = asked.trees[root.tree];
            }
        }
    }
    // Blocks with more than one tree read them from here.
    std::copy(asked.trees.begin(), asked.trees.end(), parts.query_trees);
}

/// Copies the touching pairs of one query to its list, sorted by ids.
void fill_list(const TriangleIds* from, std::uint32_t room, const Query& query,
               const QueryResult& result) noexcept {
    const std::size_t count =
        std::min({std::size_t{result.touching}, query.list.size(), std::size_t{room}});
    std::copy(from, from + count, query.list.begin());
    std::sort(query.list.begin(), query.list.begin() + static_cast<std::ptrdiff_t>(count));
}

/// Input of one launch: parts of boxes, followed by queries.
struct Asked {
    const PartQueries& parts;
    std::span<const Query> queries;
};

/// Writes the batch to pinned memory. Returns the graph to launch.
const BatchGraph& place_batch(CudaEngine::Parts& parts, const Asked& asked,
                              std::span<const GroupWork> groups) noexcept {
    const auto part_count = static_cast<std::uint32_t>(asked.parts.count());
    const auto query_count = static_cast<std::uint32_t>(asked.queries.size());
    bool measures = false, has_rechecks = false;
    ++parts.sequence;
    {
        GroupPlaces places(parts, groups);
        place_parts(parts, asked.parts, places);
        for (std::size_t i = 0; i < asked.queries.size(); ++i) {
            Query& query = parts.queries[i] = asked.queries[i];
            query.group = places.of(query.group);
            measures = measures || query.kind == QueryKind::clearance;
            has_rechecks = has_rechecks || !query.is_float_only || query.kind != QueryKind::farther;
        }
    }
    *parts.head = {.sequence = parts.sequence,
                   .count = part_count + query_count,
                   .groups = static_cast<std::uint32_t>(parts.groups_here.size()),
                   .parts = part_count,
                   .depth = asked.parts.depth};
    std::memset(static_cast<void*>(parts.results), kPoison,
                (part_count + query_count) * sizeof(DeviceResult));
    std::memset(static_cast<void*>(parts.groups_out), kPoison,
                parts.groups_here.size() * sizeof(DeviceGroupResult));
    std::atomic_thread_fence(std::memory_order_seq_cst);
    return part_count != 0                    ? parts.part_stages
           : !groups.empty() && !has_rechecks ? parts.float_stages
           : !groups.empty()                  ? parts.stages
           : measures                         ? parts.clearances
                                              : parts.proofs;
}

/// Runs one launch, in groups if `groups` is not empty. False: the engine is dead, and all its
/// results are void.
bool run_batch(CudaEngine::Parts& parts, const Asked& asked, std::span<QueryResult> results,
               std::span<GroupWork> groups) noexcept {
    const Clock::time_point deadline = Clock::now() + std::chrono::microseconds(parts.deadline_us);
    const BatchGraph& batch = place_batch(parts, asked, groups);
    const std::uint32_t sequence = parts.sequence, room = parts.buffers.limits.listed;
    if (cudaGraphLaunch(batch.exec, parts.partition.stream) != cudaSuccess) {
        parts.give_up("the GPU refused a batch");
        return false;
    }
    const std::size_t first = results.size() - asked.queries.size();
    for (std::size_t i = 0; i < results.size(); ++i) {
        __builtin_prefetch(parts.results + std::min(i + kAhead, results.size() - 1));
        if (!wait_for(parts.results[i], sequence, deadline, results[i])) {
            parts.give_up("an answer of the GPU did not come whole in time");
            return false;
        }
        if (results[i].status == QueryStatus::not_run) {
            parts.give_up("a kernel of the batch did not do its work");
            return false;
        }
        if (i >= first) {
            fill_list(parts.listed + i * room, room, asked.queries[i - first], results[i]);
        }
    }
    for (std::size_t i = 0; i < parts.groups_here.size(); ++i) {
        if (!wait_for(parts.groups_out[i], sequence, deadline, groups[parts.groups_here[i]])) {
            parts.give_up("what a group used did not come whole in time");
            return false;
        }
    }
    return true;
}

/// Sets all results to not_run. False: they are bad_rounding, because this thread computes the
/// poses and does not round to nearest.
bool begin(std::span<QueryResult> results) noexcept {
    const bool is_exact = rounds_to_nearest();
    std::fill(results.begin(), results.end(),
              QueryResult{.status = is_exact ? QueryStatus::not_run : QueryStatus::bad_rounding});
    return is_exact;
}

/// Refuses a result if its group exceeded a share in all launches together.
void refuse(QueryResult& result, const GroupWork& group) noexcept {
    const QueryStatus full = first_full(group);
    if (full != QueryStatus::ok) {
        result = QueryResult{.status = full};
    }
}

}  // namespace

CudaEngine::CudaEngine(std::unique_ptr<Parts> parts) noexcept : parts_(std::move(parts)) {}
CudaEngine::CudaEngine(CudaEngine&&) noexcept = default;

CudaEngine::~CudaEngine() {
    // The device of a dead engine may hang: waiting for it here could block without end.
    if (parts_ == nullptr || parts_->fault != nullptr) {
        return;
    }
    // A kernel may still write after its last result, and freeing waits for the device but not for
    // a partition of it.
    static_cast<void>(cudaStreamSynchronize(parts_->partition.stream));
    for (const cuda::BatchGraph& batch : {parts_->proofs, parts_->clearances, parts_->stages,
                                          parts_->float_stages, parts_->part_stages}) {
        static_cast<void>(cudaGraphExecDestroy(batch.exec));
        static_cast<void>(cudaGraphDestroy(batch.graph));
    }
    close_partition(parts_->partition);
    static_cast<void>(cudaFree(parts_->device_memory));
    static_cast<void>(cudaFreeHost(parts_->pinned_memory));
}

void CudaEngine::run(std::span<const Query> queries, std::span<QueryResult> results) noexcept {
    run(queries, results, {});
}

void CudaEngine::run(std::span<const Query> queries, std::span<QueryResult> results,
                     std::span<GroupWork> groups) noexcept {
    AXG_ASSERT(queries.size() == results.size() && groups.size() <= kGroupsMax);
    if (!begin(results)) {
        return;
    }
    const std::size_t room = parts_->buffers.limits.queries;
    for (std::size_t at = 0; at < queries.size() && parts_->fault == nullptr; at += room) {
        const std::size_t count = std::min(room, queries.size() - at);
        if (!run_batch(*parts_, {{}, queries.subspan(at, count)}, results.subspan(at, count),
                       groups)) {
            std::fill(results.begin(), results.end(), QueryResult{});
        }
    }
    for (std::size_t i = 0; !groups.empty() && parts_->fault == nullptr && i < results.size();
         ++i) {
        refuse(results[i], groups[queries[i].group]);
    }
}

void CudaEngine::run(const PartQueries& parts, std::span<const Query> queries,
                     std::span<QueryResult> results, std::span<GroupWork> groups) noexcept {
    const std::size_t count = parts.count();
    AXG_ASSERT(count + queries.size() == results.size() && results.size() <= parts_max() &&
               parts.trees.size() <= kQueryTreesMax && parts.depth >= 1 &&
               parts.depth <= kTreeDepthOfParts && !groups.empty() && groups.size() <= kGroupsMax);
    const auto is_of_float = [](const auto& asked) { return asked.is_float_only; };
    AXG_ASSERT(std::all_of(queries.begin(), queries.end(), is_of_float) &&
               std::all_of(parts.trees.begin(), parts.trees.end(), is_of_float));
    if (!begin(results) || parts_->fault != nullptr) {
        return;
    }
    if (!run_batch(*parts_, {parts, queries}, results, groups)) {
        std::fill(results.begin(), results.end(), QueryResult{});
        return;
    }
    for (std::size_t i = 0; i < results.size(); ++i) {
        refuse(results[i],
               groups[i < count ? parts.roots[i >> parts.depth].group : queries[i - count].group]);
    }
}

std::uint32_t CudaEngine::parts_max() const noexcept {
    return parts_->buffers.limits.queries;
}

Engine CudaEngine::engine() noexcept {
    Engine out;
    out.self = this;
    out.run = [](void* self, std::span<const Query> queries,
                 std::span<QueryResult> results) noexcept {
        static_cast<CudaEngine*>(self)->run(queries, results);
    };
    out.run_groups = [](void* self, std::span<const Query> queries, std::span<QueryResult> results,
                        std::span<GroupWork> groups) noexcept {
        static_cast<CudaEngine*>(self)->run(queries, results, groups);
    };
    out.run_parts = [](void* self, const PartQueries& parts, std::span<const Query> queries,
                       std::span<QueryResult> results, std::span<GroupWork> groups) noexcept {
        static_cast<CudaEngine*>(self)->run(parts, queries, results, groups);
    };
    out.parts_max = parts_max();
    out.prefers_batches = true;
    return out;
}

const char* CudaEngine::fault() const noexcept {
    return parts_->fault;
}
const CudaMemoryPlan& CudaEngine::memory() const noexcept {
    return parts_->memory_plan;
}
const CudaDevice& CudaEngine::device() const noexcept {
    return parts_->device;
}
std::uint32_t CudaEngine::tree_levels() const noexcept {
    return parts_->buffers.limits.tree_levels;
}

}  // namespace axg
