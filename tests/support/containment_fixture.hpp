// SPDX-License-Identifier: Apache-2.0
// Bodies ready to be queried for winding numbers and containment, and short ways to query.
#pragma once

#include <gtest/gtest.h>

#include <optional>
#include <utility>
#include <vector>

#include "core/collision/containment.hpp"
#include "core/collision/tree.hpp"
#include "core/collision/winding.hpp"
#include "core/mesh/surface_parts.hpp"
#include "tests/support/engine_fixture.hpp"
#include "tests/support/solids.hpp"

namespace axg::test {

/// One body's tree with its closed shells marked.
class SolidBody {
  public:
    explicit SolidBody(Triangles triangles)
        : triangles_(std::move(triangles)),
          tree_(build_tree(triangles_)),
          closed_(closed_masks(tree_.nodes, tree_.leaves, take_apart(triangles_).is_closed)) {}
    [[nodiscard]] const Triangles& triangles() const { return triangles_; }
    [[nodiscard]] Solid solid() const { return {{tree_.nodes, tree_.leaves, 0}, closed_}; }
    [[nodiscard]] Winding wound(const Vec3d& point, RayWork& work,
                                const Capacities& capacities = {}) const {
        return winding_number(solid(), point, capacities, work);
    }
    /// The number alone, of a point where it must be known.
    [[nodiscard]] int at(const Vec3d& point) const {
        RayWork work;
        const Winding out = wound(point, work);
        EXPECT_TRUE(out.is_known) << point.x << ' ' << point.y << ' ' << point.z;
        EXPECT_EQ(work.status, QueryStatus::ok);
        return out.number;
    }

  private:
    Triangles triangles_;
    TreeData tree_;
    std::vector<std::uint32_t> closed_;
};

/// An engine and the containment test on its trees.
class ContainmentScene {
  public:
    explicit ContainmentScene(std::vector<Mesh> meshes, const Capacities& capacities = {})
        : meshes_(std::move(meshes)),
          engine_(engine_over(meshes_, capacities)),
          containment_test_(
              ContainmentTest::create(pointers_to(meshes_), engine_->trees(), capacities)) {
        EXPECT_TRUE(containment_test_.has_value());
    }
    [[nodiscard]] CpuEngine& engine() { return *engine_; }
    [[nodiscard]] const std::vector<Mesh>& meshes() const { return meshes_; }
    [[nodiscard]] const ContainmentTest& containment_test() const { return *containment_test_; }

    /// Mesh 0 at `pose` in mesh 1's frame.
    [[nodiscard]] static Query about(const Pose& pose, std::uint32_t a = 0, std::uint32_t b = 1) {
        Query q;
        q.mesh_a = a;
        q.mesh_b = b;
        q.pose = pose;
        q.pose_error_mm = kPlaceErrorMm;
        return q;
    }
    [[nodiscard]] ContainmentResult run(const Query& query) {
        const QueryResult surfaces = test::run_query(*engine_, query);
        ContainmentResult result;
        containment_test_->run({&query, 1}, {&surfaces, 1}, {&result, 1});
        return result;
    }
    [[nodiscard]] Containment judge(const Pose& pose, std::uint32_t a = 0, std::uint32_t b = 1) {
        return run(about(pose, a, b)).containment;
    }

  private:
    static std::vector<const Mesh*> pointers_to(const std::vector<Mesh>& meshes) {
        std::vector<const Mesh*> out;
        for (const Mesh& mesh : meshes) {
            out.push_back(&mesh);
        }
        return out;
    }

    std::vector<Mesh> meshes_;
    std::optional<CpuEngine> engine_;
    std::optional<ContainmentTest> containment_test_;
};

}  // namespace axg::test
