// SPDX-License-Identifier: Apache-2.0
// Surfaces put to every lane set of this processor, two at a time, and judged in exact arithmetic
// with the numbers of the pose taken as they are: no claim may be false. Header-only: the tests
// that use it have GMP.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "tests/support/engine_fixture.hpp"
#include "tests/support/exact_bodies.hpp"

namespace axg::test {

struct JudgedPair {
    bool meets = false;          // exactly: the surfaces share a point
    double distance_mm = 0;      // exact, then rounded
    bool is_far = false;         // proven
    double clearance_mm = 0;     // certified
    std::uint32_t touching = 0;  // pairs of triangles that are not proven apart
    std::uint32_t meeting = 0;   // pairs that exactly share a point
};

class JudgedScene {
  public:
    explicit JudgedScene(std::vector<Mesh> meshes) : meshes_(std::move(meshes)) {
        for (const LaneSet set : lane_sets()) {
            engines_.push_back(std::move(*engine_over(meshes_, {}, set)));
        }
        EXPECT_FALSE(engines_.empty());
    }

    /// Mesh a at `pose` in the frame of mesh b.
    [[nodiscard]] JudgedPair judge(std::uint32_t a, std::uint32_t b, const Pose& pose = {}) {
        const ExactScene truth(meshes_[a], meshes_[b], pose, kMarginMmMax);
        JudgedPair out{.meets = truth.distance().is_zero(), .distance_mm = truth.distance_mm()};
        for (const ExactPair& pair : truth.near()) {
            out.meeting += pair.square.is_zero() ? 1 : 0;
        }
        for (CpuEngine& engine : engines_) {
            JudgedPair found = out;
            put_to(engine, {.mesh_a = a, .mesh_b = b, .pose = pose}, truth, found);
            EXPECT_TRUE(&engine == &engines_.front() || same(found, last_)) << engine.lanes();
            last_ = found;
        }
        return last_;
    }

  private:
    static bool same(const JudgedPair& x, const JudgedPair& y) {
        return x.is_far == y.is_far && x.clearance_mm == y.clearance_mm && x.touching == y.touching;
    }

    void put_to(CpuEngine& engine, Query query, const ExactScene& truth, JudgedPair& out) const {
        const QueryResult farther = run_query(engine, query);
        EXPECT_EQ(farther.status, QueryStatus::ok);
        out.is_far = farther.proof == Proof::far;
        EXPECT_FALSE(out.meets && out.is_far) << engine.lanes() << ": told apart, and they meet";

        std::vector<TriangleIds> list(meshes_[query.mesh_a].triangles.size() *
                                      meshes_[query.mesh_b].triangles.size());
        query.kind = QueryKind::touching;
        query.list = list;
        const QueryResult touching = run_query(engine, query);
        ASSERT_LE(touching.touching, list.size());
        out.touching = touching.touching;
        list.resize(touching.touching);
        std::sort(list.begin(), list.end());
        for (const ExactPair& pair : truth.near()) {
            EXPECT_TRUE(!pair.square.is_zero() ||
                        std::binary_search(list.begin(), list.end(), pair.ids))
                << engine.lanes() << ": triangles " << pair.ids.a << ", " << pair.ids.b
                << " meet and are not listed";
        }

        query.kind = QueryKind::clearance;
        query.list = {};
        query.r_mm = kMarginMmMax;
        out.clearance_mm = run_query(engine, query).clearance_mm;
        EXPECT_TRUE(out.clearance_mm == 0 || truth.distance().at_least(out.clearance_mm))
            << engine.lanes() << ": claimed " << out.clearance_mm;
    }

    std::vector<Mesh> meshes_;
    std::vector<CpuEngine> engines_;
    JudgedPair last_;
};

}  // namespace axg::test
