// SPDX-License-Identifier: Apache-2.0
// Last kernel of a batch: one answer a question into pinned memory, each with the batch's number
// and a check word, so that the host knows by each alone that it is whole. Far only where every
// list was long enough and everything listed was handled: a kernel that did not run shows here.
#include "cuda/device_walk.cuh"
#include "cuda/kernels.hpp"

namespace axg::cuda {
namespace {

constexpr unsigned kThreads = kBatchQuestionsMax;

/// Whether every pair of nodes that was listed was looked at, in trees that are as they were; and
/// whether there was no room for one, or for a pair of triangles.
struct BatchState {
    bool is_complete, is_over, is_over_triangles;
};

__device__ BatchState state_of(const Progress& progress, const DeviceLimits& limits,
                               const TreeSums& sums) {
    BatchState state{
        true, progress.leaf_listed > limits.leaf_pairs || progress.box_rows > limits.box_rows,
        progress.triangle_pairs > limits.batch_triangle_pairs};
    for (std::uint32_t i = 0; i < kLevelsMax; ++i) {
        state.is_over = state.is_over || progress.listed[i] > limits.level_pairs;
        state.is_complete =
            state.is_complete && progress.handled[i] == min(progress.listed[i], limits.level_pairs);
    }
    state.is_complete =
        state.is_complete && progress.leaf_handled == min(progress.leaf_listed, limits.leaf_pairs);
    const bool is_same =
        sums.found[progress.sequence % 2] == sums.wanted[progress.sequence % sums.slices];
    state.is_complete = state.is_complete && is_same;
    return state;
}

__device__ bool has_seen_all(const Tally& tally, const DeviceLimits& limits, Ask ask) {
    if (ask != Ask::clearance) {
        const std::uint32_t wanted = rechecks_wanted(tally, limits);
        return wanted == 0 || tally.recheck_room == kRoomRefused ||
               (tally.recheck_room == kRoomGiven && tally.recheck_done == wanted);
    }
    const std::uint32_t candidates = min(tally.candidates, limits.candidates);
    return tally.candidates_done[0] == candidates && tally.candidates_done[1] == candidates &&
           tally.candidates_done[2] == candidates;
}

__device__ AnswerStatus status_of(const Tally& tally, const DeviceLimits& limits,
                                  const BatchState& state, Ask ask) {
    if (!state.is_complete || !has_seen_all(tally, limits, ask)) {
        return AnswerStatus::not_run;
    }
    if (tally.refused != 0) {
        return AnswerStatus::bad_question;
    }
    if (state.is_over || is_over(tally, kLevelsMax - 1, limits.node_pairs)) {
        return AnswerStatus::too_many_node_pairs;
    }
    if (state.is_over_triangles || tally.triangle_pairs > limits.triangle_pairs) {
        return AnswerStatus::too_many_triangle_pairs;
    }
    if (ask == Ask::clearance
            ? tally.candidates > limits.candidates
            : tally.rechecks > limits.rechecks || tally.recheck_room == kRoomRefused) {
        return AnswerStatus::too_many_rechecks;
    }
    return AnswerStatus::ok;
}

__device__ void tell_clearance(const Tally& tally, const Ready& q, DeviceAnswer& answer) {
    const unsigned long long least = min(tally.least_first, tally.least_second);
    const double best = __builtin_bit_cast(double, least);
    answer.clearance_mm = best > 0 ? best : 0;
    answer.proof = static_cast<std::uint32_t>(best > 0 ? Proof::far : Proof::not_proven);
    if (best < q.r_mm) {
        answer.nearest_a = static_cast<std::uint32_t>(tally.nearest >> 32U);
        answer.nearest_b = static_cast<std::uint32_t>(tally.nearest);
    }
}

__device__ DeviceAnswer answer_of(const DeviceBuffers& b, std::uint32_t index,
                                  const BatchState& state) {
    const Tally& tally = b.tallies[index];
    const Ready& q = b.ready[index];
    DeviceAnswer answer{};
    answer.sequence = tally.sequence;
    const AnswerStatus status = status_of(tally, b.limits, state, q.ask);
    answer.status = static_cast<std::uint32_t>(status);
    if (tally.refused == 0) {
        for (const std::uint32_t pairs : tally.pairs_at) {
            answer.node_pairs += pairs;
        }
        answer.triangle_pairs = tally.triangle_pairs;
        answer.rechecks = q.ask == Ask::clearance ? tally.candidates : tally.rechecks;
    }
    if (status == AnswerStatus::ok && q.ask == Ask::clearance) {
        tell_clearance(tally, q, answer);
    } else if (status == AnswerStatus::ok) {
        answer.touching = q.ask == Ask::farther ? min(tally.touching, 1U) : tally.touching;
        answer.proof =
            static_cast<std::uint32_t>(tally.touching == 0 ? Proof::far : Proof::not_proven);
    }
    answer.check = check_of(answer);
    return answer;
}

__global__ void __launch_bounds__(kThreads)
    write_answers_kernel(const __grid_constant__ DeviceBuffers b) {
    const Progress& progress = *b.progress;
    const BatchState state = state_of(progress, b.limits, b.sums);
    for (std::uint32_t i = threadIdx.x; i < progress.count; i += kThreads) {
        b.answers[i] = answer_of(b, i, state);
    }
    if (threadIdx.x == 0) {
        b.sums.found[(progress.sequence + 1) % 2] = 0;
    }
}

}  // namespace

cudaError_t launch_write_answers(const DeviceBuffers& buffers, const Launch& launch) noexcept {
    write_answers_kernel<<<1, kThreads, 0, launch.stream>>>(buffers);
    return cudaGetLastError();
}

}  // namespace axg::cuda
