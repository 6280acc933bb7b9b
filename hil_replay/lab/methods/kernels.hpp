// SPDX-License-Identifier: Apache-2.0
// The methods that are plain functions of one pair, in float and in double. One source
// (kernels.inl) in two units: plain.cpp as all the project is compiled, fused.cpp with contraction
// allowed.
#pragma once

#include <span>

#include "hil_replay/lab/cases/pair.hpp"

namespace axg::lab {

struct Kernel {
    const char* name;  // without the scalar type
    JudgePairs<float> f32;
    JudgePairs<double> f64;
};

[[nodiscard]] std::span<const Kernel> plain_kernels() noexcept;
/// Empty if this build has no such unit. Run them only on a processor with FMA.
[[nodiscard]] std::span<const Kernel> fused_kernels() noexcept;

}  // namespace axg::lab
