// SPDX-License-Identifier: Apache-2.0
// An engine over a few surfaces, and short ways to query it.
#pragma once

#include <gtest/gtest.h>

#include <optional>
#include <vector>

#include "core/collision/cpu_engine.hpp"

namespace axg::test {

inline std::optional<CpuEngine> engine_over(const std::vector<Mesh>& meshes,
                                            const Capacities& capacities = {},
                                            LaneSet lanes = LaneSet::widest) {
    std::vector<const Mesh*> pointers;
    for (const Mesh& mesh : meshes) {
        pointers.push_back(&mesh);
    }
    return CpuEngine::create(pointers, capacities, lanes);
}

inline QueryResult run_query(CpuEngine& engine, const Query& query) {
    QueryResult result;
    engine.run({&query, 1}, {&result, 1});
    return result;
}

/// Every lane set that this processor runs.
inline std::vector<LaneSet> lane_sets() {
    std::vector<LaneSet> sets;
    for (const LaneSet set : {LaneSet::avx512, LaneSet::avx2, LaneSet::neon}) {
        if (has_lane_set(set)) {
            sets.push_back(set);
        }
    }
    return sets;
}

inline Pose shifted(double x, double y, double z) {
    Pose p;
    p.t[0] = x;
    p.t[1] = y;
    p.t[2] = z;
    return p;
}

}  // namespace axg::test
