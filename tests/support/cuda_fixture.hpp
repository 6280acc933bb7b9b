// SPDX-License-Identifier: Apache-2.0
// A CUDA engine for a test, or the reason why there is none here.
#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <optional>
#include <string>
#include <vector>

#include "cuda/engine/cuda_engine.hpp"

namespace axg::test {

inline std::uint32_t number_from(const char* name, std::uint32_t usual) {
    const char* const text = std::getenv(name);
    return text == nullptr ? usual : static_cast<std::uint32_t>(std::strtoul(text, nullptr, 10));
}

/// Lists of a batch so long that no query is lost for what others need: what is compared then is
/// each query's own capacities.
inline Capacities ample(Capacities capacities = {}) {
    capacities.batch = {1U << 16U, 1U << 17U, 1U << 24U, 1U << 26U, 1U << 20U};
    return capacities;
}

/// Empty where no GPU answers; the test says skipped. AXG_SMS: on so many multiprocessors;
/// AXG_DEADLINE_US: for a checker under which kernels take long.
inline std::optional<CudaEngine> cuda_engine_over(const std::vector<Mesh>& meshes,
                                                  const Capacities& capacities, CudaOptions options,
                                                  std::string& fault) {
    std::vector<const Mesh*> pointers;
    for (const Mesh& mesh : meshes) {
        pointers.push_back(&mesh);
    }
    options.multiprocessors = number_from("AXG_SMS", options.multiprocessors);
    options.deadline_us = number_from("AXG_DEADLINE_US", options.deadline_us);
    std::optional<CudaEngine> made = CudaEngine::create(pointers, capacities, options, fault);
    EXPECT_EQ(fault.find("warm-up"), std::string::npos) << "there is a GPU: " << fault;
    return made;
}

}  // namespace axg::test

/// An engine named `name`, or a skipped test that says why.
#define AXG_CUDA_ENGINE_OR_SKIP(name, meshes, capacities, options)              \
    std::string name##_fault;                                                   \
    std::optional<axg::CudaEngine> name##_made =                                \
        axg::test::cuda_engine_over(meshes, capacities, options, name##_fault); \
    if (!name##_made) {                                                         \
        GTEST_SKIP() << name##_fault;                                           \
    }                                                                           \
    axg::CudaEngine& name = *name##_made
