// SPDX-License-Identifier: Apache-2.0
// An offline engine for a test, or the reason why there is none here.
#pragma once

#include <gtest/gtest.h>

#include <optional>
#include <string>
#include <vector>

#include "cuda/offline/offline_engine.hpp"
#include "tests/support/cuda_fixture.hpp"

namespace axg::test {

inline std::optional<OfflineEngine> offline_engine_over(const std::vector<Mesh>& meshes,
                                                        const Capacities& capacities,
                                                        OfflineOptions options,
                                                        std::string& fault) {
    std::vector<const Mesh*> pointers;
    for (const Mesh& mesh : meshes) {
        pointers.push_back(&mesh);
    }
    options.deadline_us = number_from("AXG_DEADLINE_US", options.deadline_us);
    std::optional<OfflineEngine> made =
        OfflineEngine::create(pointers, capacities, {}, {}, options, fault);
    EXPECT_EQ(fault.find("warm-up"), std::string::npos) << "there is a GPU: " << fault;
    return made;
}

}  // namespace axg::test

/// An engine named `name`, or a skipped test that says why.
#define AXG_OFFLINE_ENGINE_OR_SKIP(name, meshes, capacities, options)              \
    std::string name##_fault;                                                      \
    std::optional<axg::OfflineEngine> name##_made =                                \
        axg::test::offline_engine_over(meshes, capacities, options, name##_fault); \
    if (!name##_made) {                                                            \
        GTEST_SKIP() << name##_fault;                                              \
    }                                                                              \
    axg::OfflineEngine& name = *name##_made
