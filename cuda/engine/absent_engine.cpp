// SPDX-License-Identifier: Apache-2.0
// Replaces the CUDA engine in a build without a CUDA compiler: create() reports that it is absent.
#include "core/base/assert.hpp"
#include "cuda/engine/cuda_engine.hpp"

namespace axg {

struct CudaEngine::Parts {
    CudaMemoryPlan memory_plan;
    CudaDevice device;
};

std::optional<CudaEngine> CudaEngine::create(std::span<const Mesh* const>, const Capacities&,
                                             const CudaOptions&, std::string& fault) {
    fault = kNoCudaInThisBuild;
    return std::nullopt;
}

// create() returns no engine in this build, so no caller can reach these functions.
CudaEngine::CudaEngine(std::unique_ptr<Parts> parts) noexcept : parts_(std::move(parts)) {}
CudaEngine::CudaEngine(CudaEngine&&) noexcept = default;
CudaEngine::~CudaEngine() = default;
void CudaEngine::run(std::span<const Query>, std::span<QueryResult>) noexcept {
    AXG_ASSERT(false);
}
void CudaEngine::run(std::span<const Query>, std::span<QueryResult>,
                     std::span<GroupWork>) noexcept {
    AXG_ASSERT(false);
}
void CudaEngine::run(const PartQueries&, std::span<const Query>, std::span<QueryResult>,
                     std::span<GroupWork>) noexcept {
    AXG_ASSERT(false);
}
std::uint32_t CudaEngine::parts_max() const noexcept {
    return 0;
}
Engine CudaEngine::engine() noexcept {
    AXG_ASSERT(false);
    return {};
}
const char* CudaEngine::fault() const noexcept {
    return "absent";
}
const CudaMemoryPlan& CudaEngine::memory() const noexcept {
    return parts_->memory_plan;
}
const CudaDevice& CudaEngine::device() const noexcept {
    return parts_->device;
}
std::uint32_t CudaEngine::tree_levels() const noexcept {
    return 0;
}

}  // namespace axg
