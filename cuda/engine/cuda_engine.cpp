// SPDX-License-Identifier: Apache-2.0
// A batch as the host sees it: queries into pinned memory, one launch, results polled until the
// deadline. Nothing here allocates, and nothing waits without a limit.
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

constexpr int kPoison = 0xa5;  // no result that was not written looks like one

/// One result out of pinned memory; false where it is not there yet, or not whole.
bool read_result(DeviceResult& from, std::uint32_t sequence, QueryResult& to) noexcept {
    if (std::atomic_ref<std::uint32_t>(from.sequence).load(std::memory_order_acquire) != sequence) {
        return false;
    }
    const DeviceResult copy = from;
    std::atomic_signal_fence(std::memory_order_seq_cst);  // read again each time
    if (copy.sequence != sequence || copy.check != check_of(copy) ||
        copy.status > static_cast<std::uint32_t>(QueryStatus::bad_rounding) || copy.proof > 1) {
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

/// Polls one result. False: it did not come whole in time.
bool wait_for(DeviceResult& from, std::uint32_t sequence, Clock::time_point deadline,
              QueryResult& to) noexcept {
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

/// The touching pairs of one query into its list, in the order of their ids.
void fill_list(const TriangleIds* from, std::uint32_t room, const Query& query,
               const QueryResult& result) noexcept {
    const std::size_t count =
        std::min({std::size_t{result.touching}, query.list.size(), std::size_t{room}});
    std::copy(from, from + count, query.list.begin());
    std::sort(query.list.begin(), query.list.begin() + static_cast<std::ptrdiff_t>(count));
}

/// One launch. False: the engine is dead, and no result of it counts.
bool run_batch(CudaEngine::Parts& parts, std::span<const Query> queries,
               std::span<QueryResult> results) noexcept {
    const Clock::time_point deadline = Clock::now() + std::chrono::microseconds(parts.deadline_us);
    const DeviceLimits& limits = parts.buffers.limits;
    const std::uint32_t sequence = ++parts.sequence;
    bool measures = false;
    for (std::size_t i = 0; i < queries.size(); ++i) {
        measures = measures || queries[i].kind == QueryKind::clearance;
        parts.queries[i] = queries[i];
    }
    const bool begins = measures || !parts.has_cycles || parts.begins_cycle;
    parts.begins_cycle = parts.begins_cycle && measures;  // those are no part of a cycle
    *parts.head = {sequence, static_cast<std::uint32_t>(queries.size()), begins ? 1U : 0U};
    std::memset(static_cast<void*>(parts.results), kPoison, queries.size() * sizeof(DeviceResult));
    std::atomic_thread_fence(std::memory_order_seq_cst);
    const BatchGraph& batch = measures ? parts.clearances : parts.proofs;
    if (cudaGraphLaunch(batch.exec, parts.partition.stream) != cudaSuccess) {
        parts.give_up("the GPU refused a batch");
        return false;
    }
    for (std::size_t i = 0; i < queries.size(); ++i) {
        if (!wait_for(parts.results[i], sequence, deadline, results[i])) {
            parts.give_up("an answer of the GPU did not come whole in time");
            return false;
        }
        if (results[i].status == QueryStatus::not_run) {
            parts.give_up("a kernel of the batch did not do its work");
            return false;
        }
        fill_list(parts.listed + i * limits.listed, limits.listed, queries[i], results[i]);
    }
    return true;
}

}  // namespace

CudaEngine::CudaEngine(std::unique_ptr<Parts> parts) noexcept : parts_(std::move(parts)) {}
CudaEngine::CudaEngine(CudaEngine&&) noexcept = default;

CudaEngine::~CudaEngine() {
    // A dead engine's device may never come back: waiting for it here could take for ever.
    if (parts_ == nullptr || parts_->fault != nullptr) {
        return;
    }
    for (const cuda::BatchGraph& batch : {parts_->proofs, parts_->clearances}) {
        static_cast<void>(cudaGraphExecDestroy(batch.exec));
        static_cast<void>(cudaGraphDestroy(batch.graph));
    }
    static_cast<void>(cudaStreamDestroy(parts_->partition.stream));
    static_cast<void>(cudaFree(parts_->device_memory));
    static_cast<void>(cudaFreeHost(parts_->pinned_memory));
}

void CudaEngine::run(std::span<const Query> queries, std::span<QueryResult> results) noexcept {
    AXG_ASSERT(queries.size() == results.size());
    std::fill(results.begin(), results.end(), QueryResult{});
    if (!rounds_to_nearest()) {  // the poses come from this thread
        std::fill(results.begin(), results.end(), QueryResult{.status = QueryStatus::bad_rounding});
        return;
    }
    const std::size_t room = parts_->buffers.limits.queries;
    for (std::size_t at = 0; at < queries.size() && parts_->fault == nullptr; at += room) {
        const std::size_t count = std::min(room, queries.size() - at);
        if (!run_batch(*parts_, queries.subspan(at, count), results.subspan(at, count))) {
            std::fill(results.begin(), results.end(), QueryResult{});
        }
    }
}

void CudaEngine::begin_cycle() noexcept {
    parts_->has_cycles = parts_->begins_cycle = true;
}

Engine CudaEngine::engine() noexcept {
    Engine out;
    out.self = this;
    out.run = [](void* self, std::span<const Query> queries,
                 std::span<QueryResult> results) noexcept {
        static_cast<CudaEngine*>(self)->begin_cycle();
        static_cast<CudaEngine*>(self)->run(queries, results);
    };
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
