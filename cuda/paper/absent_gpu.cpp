// SPDX-License-Identifier: Apache-2.0
// Replaces the paper's kernels in a build without a CUDA compiler: create() reports that they are
// absent.
#include "core/base/assert.hpp"
#include "cuda/paper/paper_gpu.hpp"

namespace axg::paper {

struct Gpu::Parts {
    Device device;
    std::string fault;
};

std::optional<Gpu> Gpu::create(const Scene&, unsigned, std::string& fault) {
    fault = "this build has none of the kernels; build it where nvcc is on the path";
    return std::nullopt;
}

// create() returns no Gpu in this build, so no caller can reach these functions.
Gpu::Gpu(std::unique_ptr<Parts> parts) noexcept : parts_(std::move(parts)) {}
Gpu::Gpu(Gpu&&) noexcept = default;
Gpu::~Gpu() = default;
bool Gpu::run_paper(const Techniques&, Timing, std::uint32_t, std::span<const PairPose>,
                    std::span<Found>, std::span<double>) {
    AXG_ASSERT(false);
    return false;
}
bool Gpu::run_certified(Timing, std::uint32_t, std::span<const PairPose>, std::span<Found>,
                        std::span<double>) {
    AXG_ASSERT(false);
    return false;
}
const Device& Gpu::device() const noexcept {
    return parts_->device;
}
const std::string& Gpu::fault() const noexcept {
    return parts_->fault;
}
std::vector<KernelFacts> Gpu::kernels() const {
    return {};
}

}  // namespace axg::paper
