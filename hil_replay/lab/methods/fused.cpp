// SPDX-License-Identifier: Apache-2.0
// The plain methods once more, with contraction allowed: the one unit of the project where a
// compiler may fuse a product and a sum. The laboratory measures its effect on methods that depend
// on signs; the guard never uses this unit. Flags: CMakeLists.txt of this folder.
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
