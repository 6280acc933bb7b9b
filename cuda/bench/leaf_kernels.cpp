// SPDX-License-Identifier: Apache-2.0
#include "cuda/bench/leaf_kernels.hpp"

#include <array>

namespace axg {

std::span<const LeafKernel> leaf_kernels() noexcept {
    static constexpr std::array<LeafKernel, 4> kKernels = {
        {{"computed", nullptr},
         {"cached", &cuda::launch_leaves_cached},
         {"prefetched", &cuda::launch_leaves_prefetched},
         {"rolled", &cuda::launch_leaves_rolled}}};
    return kKernels;
}

}  // namespace axg
