// SPDX-License-Identifier: Apache-2.0
// axguard's own engine: the relative poses are composed inside the timed cycle, all pairs are
// queried in one batch, and "not proven" counts as a contact.
#include <stdexcept>
#include <vector>

#include "core/collision/cpu_engine.hpp"
#include "core/machine/kinematics.hpp"
#include "tests/benchmarks/peer.hpp"

namespace axg::test {
namespace {

class AxguardPeer final : public Peer {
  public:
    AxguardPeer(const Scene& scene, CpuEngine engine)
        : scene_{scene},
          engine_{std::move(engine)},
          queries_(scene.pairs.size()),
          results_(scene.pairs.size()) {
        for (std::size_t pair = 0; pair < queries_.size(); ++pair) {
            queries_[pair].mesh_a = scene.pairs[pair].a;
            queries_[pair].mesh_b = scene.pairs[pair].b;
        }
    }
    [[nodiscard]] std::string name() const override {
        return "axguard " + std::string{engine_.lanes()};
    }

    void cycle(std::span<const Pose> placed, std::span<std::uint8_t> hit) override {
        for (std::size_t pair = 0; pair < queries_.size(); ++pair) {
            const ScenePair& p = scene_.pairs[pair];
            queries_[pair].pose = relative_pose(placed[p.a], placed[p.b]);
        }
        engine_.run(queries_, results_);
        for (std::size_t pair = 0; pair < results_.size(); ++pair) {
            hit[pair] = results_[pair].proof == Proof::far ? 0 : 1;
        }
    }

  private:
    const Scene& scene_;
    CpuEngine engine_;
    std::vector<Query> queries_;
    std::vector<QueryResult> results_;
};

CpuEngine engine_of(const Scene& scene, const Capacities& capacities) {
    std::vector<const Mesh*> meshes;
    for (const Mesh& mesh : scene.bodies) {
        meshes.push_back(&mesh);
    }
    auto engine = CpuEngine::create(meshes, capacities);
    if (!engine) {
        throw std::runtime_error(std::string{kNoLaneSet});
    }
    return std::move(*engine);
}

}  // namespace

std::unique_ptr<Peer> make_axguard(const Scene& scene) {
    return std::make_unique<AxguardPeer>(scene, engine_of(scene, Capacities{}));
}

std::vector<double> clearances_mm(const Scene& scene, double within_mm) {
    constexpr Capacities kRoomy{
        .node_pairs = 1U << 18U, .triangle_pairs = 1U << 24U, .rechecks = 1U << 20U};
    CpuEngine engine = engine_of(scene, kRoomy);
    std::vector<double> out;
    for (std::uint32_t pose = 0; pose < scene.pose_count; ++pose) {
        for (const ScenePair& p : scene.pairs) {
            Query query;
            query.kind = QueryKind::clearance;
            query.mesh_a = p.a;
            query.mesh_b = p.b;
            query.r_mm = within_mm;
            query.pose = relative_pose(scene.at(pose, p.a), scene.at(pose, p.b));
            QueryResult result;
            engine.run({&query, 1}, {&result, 1});
            if (result.status != QueryStatus::ok) {
                throw std::runtime_error("a clearance was not measured");
            }
            out.push_back(result.clearance_mm);
        }
    }
    return out;
}

}  // namespace axg::test
