// SPDX-License-Identifier: Apache-2.0
// The parts of the offline engine. For cuda/ and for the tests that break it on purpose.
#pragma once

#include <cuda_runtime.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "core/collision/cpu_engine.hpp"
#include "cuda/offline/offline_data.hpp"
#include "cuda/offline/offline_engine.hpp"

namespace axg::cuda {

/// The steps of a batch, one bit each.
enum OfflineStep : std::uint32_t {
    kCopyItems = 1,
    kPrepare = 2,
    kAnswer = 4,
    kCopyAnswers = 8,
};

/// A batch under way, with memory of its own.
struct OfflineSlot {
    cudaStream_t stream = nullptr;
    // The end, and if the engine measures the end of each step before.
    cudaEvent_t done = nullptr, marks[4] = {};
    OfflineBuffers buffers;  // device addresses
    std::byte *items_device = nullptr, *answers_device = nullptr;
    std::byte *items = nullptr, *answers = nullptr;  // pinned: items and positions; sums, answers
    std::size_t item_bytes = 0;                      // of the batch
    std::size_t first = 0;                           // query of the call
    std::vector<std::uint32_t> others;               // queries of another kind than `farther`
};

}  // namespace axg::cuda

namespace axg {

struct OfflineEngine::Parts {
    OfflineOptions options;
    CudaDevice device;
    CudaMemoryPlan memory_plan;
    MachineChains chains;
    std::vector<PosedPair> pairs;
    std::unique_ptr<CpuEngine> cpu;  // for what the lists are too short for
    std::byte *device_memory = nullptr, *pinned_memory = nullptr;
    std::vector<cuda::OfflineSlot> slots;
    std::vector<unsigned long long> wanted;  // sums of the slices of the trees
    std::size_t items_bytes = 0;             // room of a slot
    std::uint32_t sequence = 0;              // of the last batch
    OfflineWork work;
    std::vector<std::uint32_t> again;  // of one batch
    const char* fault = nullptr;
    std::uint32_t left_out = 0;  // for tests: steps that no batch does

    void give_up(const char* why) noexcept {
        if (fault == nullptr) {
            fault = why;
        }
    }
    ~Parts();
};

}  // namespace axg
