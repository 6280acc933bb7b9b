// SPDX-License-Identifier: Apache-2.0
#include "config/mesh/simplify_meshes.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstdint>
#include <span>
#include <string>
#include <utility>

#include "config/mesh/prune.hpp"
#include "core/collision/deviation.hpp"

#ifdef AXG_HAS_MESHOPTIMIZER
#include <meshoptimizer.h>
#endif

namespace axg {

#ifdef AXG_HAS_MESHOPTIMIZER

namespace {

/// Error limits for the proposals, as shares of the deviation that the machine file allows:
/// meshoptimizer's measure of error is neither an upper nor a lower bound of the deviation.
constexpr float kShares[] = {2.0F, 1.0F, 0.7F, 0.5F, 0.35F, 0.25F, 0.1F, 0.01F};

/// Merges common corners, so that triangles that share one stay connected when it moves.
struct IndexedMesh {
    std::vector<Vec3f> corners;
    std::vector<std::uint32_t> indices;  // three a triangle
};

IndexedMesh index_of_corners(std::span<const Triangle> triangles) {
    static_assert(sizeof(Triangle) == 3 * sizeof(Vec3f) && sizeof(Vec3f) == 12);
    const std::size_t count = 3 * triangles.size();
    std::vector<std::uint32_t> places(count);
    IndexedMesh out;
    out.corners.resize(
        meshopt_generateVertexRemap(places.data(), nullptr, count, triangles.data(), count, 12));
    out.indices.resize(count);
    meshopt_remapIndexBuffer(out.indices.data(), nullptr, count, places.data());
    meshopt_remapVertexBuffer(out.corners.data(), triangles.data(), count, 12, places.data());
    return out;
}

std::vector<Triangle> propose(const IndexedMesh& mesh, float error_mm) {
    const float* const corners = &mesh.corners[0].x;
    const float scale = meshopt_simplifyScale(corners, mesh.corners.size(), 12);
    std::vector<std::uint32_t> indices(mesh.indices.size());
    indices.resize(meshopt_simplify(indices.data(), mesh.indices.data(), mesh.indices.size(),
                                    corners, mesh.corners.size(), 12, 0, error_mm / scale, 0,
                                    nullptr));
    std::vector<Triangle> out;
    for (std::size_t i = 0; i + 2 < indices.size(); i += 3) {
        out.push_back(
            {mesh.corners[indices[i]], mesh.corners[indices[i + 1]], mesh.corners[indices[i + 2]]});
    }
    return out;
}

}  // namespace

SimplifiedMesh simplify(const Mesh& whole, double most_mm) {
    const IndexedMesh indexed = index_of_corners(whole.triangles);
    Mesh best = whole;
    for (const float share : kShares) {
        Mesh fewer{whole.name, propose(indexed, share * static_cast<float>(most_mm))};
        if (fewer.triangles.empty() || fewer.triangles.size() >= best.triangles.size()) {
            continue;
        }
        // Remove proposed triangles that are too far off; add whole ones that they do not cover.
        prune(triangles_beyond(fewer.triangles, whole.triangles, most_mm), fewer.triangles);
        if (fewer.triangles.empty()) {
            continue;
        }
        for (const std::uint32_t i : triangles_beyond(whole.triangles, fewer.triangles, most_mm)) {
            fewer.triangles.push_back(whole.triangles[i]);
        }
        if (fewer.triangles.size() < best.triangles.size()) {
            best = std::move(fewer);
        }
    }
    if (best.triangles.size() < whole.triangles.size()) {
        const auto deviation = bound_deviation(whole.triangles, best.triangles, most_mm);
        const auto excess = bound_deviation(best.triangles, whole.triangles, most_mm);
        if (deviation && excess) {
            return {std::move(best), *deviation, *excess};
        }
    }
    return {whole, 0, 0};
}

constexpr bool kCanSimplify = true;

#else

SimplifiedMesh simplify(const Mesh& whole, double /*most_mm*/) {
    return {whole, 0, 0};
}

constexpr bool kCanSimplify = false;

#endif

namespace {

void simplify_one(const std::string& key, MeshSource& source, const Mesh& whole, Mesh& out,
                  std::vector<std::string>& notes, std::vector<ConfigFault>& faults) {
    source.deviation_mm = 0;
    out = {whole.name, {}};
    if (source.simplify_mm <= 0) {
        return;
    }
    if (!kCanSimplify) {
        faults.push_back({source.where, key + ".simplify_mm", "a build without libmeshoptimizer",
                          "no such key, or an axguard built with libmeshoptimizer-dev"});
        return;
    }
    SimplifiedMesh simple = simplify(whole, source.simplify_mm);
    if (simple.deviation_mm > 0) {
        // Rounded up: what is printed holds, too.
        notes.push_back(fmt::format(
            "{}: simplified to {} of {} triangles; deviation at most {:.4f} mm, excess at most "
            "{:.4f} mm",
            key, simple.mesh.triangles.size(), whole.triangles.size(),
            std::ceil(simple.deviation_mm * 1e4) * 1e-4, std::ceil(simple.excess_mm * 1e4) * 1e-4));
        source.deviation_mm = simple.deviation_mm;
        out = std::move(simple.mesh);
    } else {
        notes.push_back(
            fmt::format("{}: not simplified: no coarser surface was found within {:g} mm; all {} "
                        "triangles are used",
                        key, source.simplify_mm, whole.triangles.size()));
    }
}

}  // namespace

std::vector<ConfigFault> simplify_meshes(Machine& machine, MachineMeshes& meshes) {
    std::vector<ConfigFault> faults;
    meshes.simple_bodies.resize(machine.bodies.size());
    meshes.simple_tools.resize(machine.tools.size());
    for (std::size_t i = 0; i < machine.bodies.size(); ++i) {
        Body& body = machine.bodies[i];
        simplify_one("bodies." + body.name + ".mesh", body.mesh, meshes.bodies[i],
                     meshes.simple_bodies[i], meshes.notes, faults);
    }
    for (std::size_t i = 0; i < machine.tools.size(); ++i) {
        Tool& tool = machine.tools[i];
        simplify_one(fmt::format("tools.{}.mesh", tool.number), tool.mesh, meshes.tools[i],
                     meshes.simple_tools[i], meshes.notes, faults);
    }
    return faults;
}

}  // namespace axg
