// SPDX-License-Identifier: Apache-2.0
// The plain methods once more, with contraction allowed: the one unit of the project where a
// compiler may fuse a product and a sum. What it does to methods that rest on signs is a result of
// the laboratory; no verdict of the guard comes from here. Flags: CMakeLists.txt of this folder.
#include "hil_replay/lab/methods/kernels.hpp"

#if defined(AXG_LAB_FUSED)
#define AXG_LAB_UNIT fused
#include "hil_replay/lab/methods/kernels.inl"

#include "hil_replay/lab/methods/kernel_table.inl"

namespace axg::lab {

std::span<const Kernel> fused_kernels() noexcept {
    return fused::kTable;
}

}  // namespace axg::lab
#else
namespace axg::lab {

std::span<const Kernel> fused_kernels() noexcept {
    return {};
}

}  // namespace axg::lab
#endif
