// SPDX-License-Identifier: Apache-2.0
// The methods that are plain functions of one pair, in float and in double. One source
// (kernels.inl) in two units: plain.cpp as all the project is compiled, fused.cpp with contraction
// allowed.
#pragma once

#include <span>

#include "hil_replay/lab/cases/pair.hpp"

namespace axg::lab {

struct Kernel {
    const char* name;  // without what it computes in
    JudgePairs<float> f32;
    JudgePairs<double> f64;
};

[[nodiscard]] std::span<const Kernel> plain_kernels() noexcept;
/// Empty where this build has no such unit; to be called only where the processor has FMA.
[[nodiscard]] std::span<const Kernel> fused_kernels() noexcept;

}  // namespace axg::lab
