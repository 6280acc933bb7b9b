// SPDX-License-Identifier: Apache-2.0
// Tests whether a part of one body is inside the other, which surfaces do not show. The surfaces of
// the pair are proven apart: then each connected part of one is wholly inside the other solid or
// wholly outside, and one of its corners decides which. Proof: docs/theory/accuracy.md,
// "Containment".
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "core/base/arena.hpp"
#include "core/collision/engine.hpp"
#include "core/collision/winding.hpp"
#include "core/machine/machine.hpp"
#include "core/mesh/mesh.hpp"
#include "core/mesh/surface_parts.hpp"

namespace axg {

enum class Containment : std::uint8_t {
    not_proven = 0,  // zeroed memory means near
    none,            // no part of either is inside the other's closed shells: a theorem
    a_in_b,          // a part of a is inside b
    b_in_a,
};

struct ContainmentResult {
    QueryStatus status = QueryStatus::not_run;  // also not_run if the surfaces are not proven
                                                // apart: the pair is near already
    Containment containment = Containment::not_proven;
    std::uint32_t rays = 0, nodes = 0, triangles = 0, exact_signs = 0;  // work done
};

/// A corner placed in the other body's frame is rounded, and may be this far from its true place.
/// So the proof of a query needs at least this pose_error_mm: then no part of the other surface is
/// between the two places.
inline constexpr double kPlaceErrorMm = 0x1p-29;

/// Two surfaces at a pose at which they are proven apart: the input of a containment test. The
/// proof is an engine's result (`apart_pose`) or one about a joint box
/// (core/certificate/joint_box_proof.hpp). Zeroed: no proof.
struct ApartPose {
    bool is_proven = false;
    std::uint32_t mesh_a = 0, mesh_b = 0;
    double pose_error_mm = 0;  // that the proof allows for
    Pose pose;                 // a's mesh frame to b's
};

/// The pose of `query`; proven if `surfaces`, the result of that query, is far.
[[nodiscard]] ApartPose apart_pose(const Query& query, const QueryResult& surfaces) noexcept;

/// The test itself, over surfaces with an inside. One arena, sealed; nothing allocates in a query.
class ContainmentTest {
  public:
    /// @param meshes  the whole surfaces, in the engine's order; a mesh without a tree stays empty
    /// @param trees   [at least meshes] the engine's trees of those meshes; they must outlive this
    /// @param same_as [meshes] an earlier one where a surface is a part of that one's body, else
    /// itself; empty: every one is a body of its own
    /// Empty: memory ran out.
    [[nodiscard]] static std::optional<ContainmentTest> create(
        std::span<const Mesh* const> meshes, std::span<const Tree> trees,
        const Capacities& capacities, std::span<const std::uint32_t> same_as = {});

    /// Returns not_run if the surfaces are not proven apart.
    /// Cost: a few corners for each part of each body, and a ray for each part whose box is in
    /// the other body's box; nodes, triangles and exact signs of one query, all rays together,
    /// within the capacities (node_pairs, triangle_pairs, rechecks).
    [[nodiscard]] ContainmentResult test(const ApartPose& at) const noexcept;

    /// Tests each query.
    /// @param surfaces  the engine's results to `queries`
    void run(std::span<const Query> queries, std::span<const QueryResult> surfaces,
             std::span<ContainmentResult> results) const noexcept;

    [[nodiscard]] std::size_t size_bytes() const noexcept { return arena_.size(); }

  private:
    struct Body {
        Solid solid;
        std::span<const SurfacePart> parts;
        bool has_inside;  // a shell is closed
    };

    ContainmentTest(Arena arena, const Capacities& capacities) noexcept;
    void judge(const ApartPose& at, ContainmentResult& result) const noexcept;
    bool is_inside(const ApartPose& at, bool is_a, RayWork& work,
                   ContainmentResult& result) const noexcept;

    Arena arena_;
    Capacities capacities_;
    std::span<Body> bodies_;
};

}  // namespace axg
