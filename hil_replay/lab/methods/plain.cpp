// SPDX-License-Identifier: Apache-2.0
// The plain methods, compiled as all the project is: no contraction.
#define AXG_LAB_UNIT plain
#include "hil_replay/lab/methods/kernels.inl"

#include "hil_replay/lab/methods/kernel_table.inl"

namespace axg::lab {

std::span<const Kernel> plain_kernels() noexcept {
    return plain::kTable;
}

}  // namespace axg::lab
