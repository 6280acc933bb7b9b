// SPDX-License-Identifier: Apache-2.0
// A build without a CUDA compiler: create() reports that the engine is absent.
#include "core/base/assert.hpp"
#include "cuda/offline/offline_engine.hpp"

namespace axg {

struct OfflineEngine::Parts {
    OfflineWork work;
    CudaDevice device;
    CudaMemoryPlan memory;
};

std::optional<OfflineEngine> OfflineEngine::create(std::span<const Mesh* const>, const Capacities&,
                                                   const MachineChains&, std::span<const PosedPair>,
                                                   const OfflineOptions&, std::string& fault) {
    fault = kNoCudaInThisBuild;
    return std::nullopt;
}

// create() returns no engine in this build, so no caller can reach these functions.
OfflineEngine::OfflineEngine(std::unique_ptr<Parts> parts) noexcept : parts_(std::move(parts)) {}
OfflineEngine::OfflineEngine(OfflineEngine&&) noexcept = default;
OfflineEngine::~OfflineEngine() = default;
void OfflineEngine::run(std::span<const Query>, std::span<QueryResult>) noexcept {
    AXG_ASSERT(false);
}
void OfflineEngine::run(const PosedQueries&, std::span<QueryResult>) noexcept {
    AXG_ASSERT(false);
}
double OfflineEngine::repeat(std::uint32_t) noexcept {
    return 0;
}
Engine OfflineEngine::engine() noexcept {
    AXG_ASSERT(false);
    return {};
}
const char* OfflineEngine::fault() const noexcept {
    return "absent";
}
const OfflineWork& OfflineEngine::work() const noexcept {
    return parts_->work;
}
const CudaDevice& OfflineEngine::device() const noexcept {
    return parts_->device;
}
const CudaMemoryPlan& OfflineEngine::memory() const noexcept {
    return parts_->memory;
}

}  // namespace axg
