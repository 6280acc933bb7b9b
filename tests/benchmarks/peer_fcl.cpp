// SPDX-License-Identifier: Apache-2.0
// FCL: a tree of OBBRSS a body, double, first contact ends the query.
#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/math/bv/OBBRSS.h>
#include <fcl/narrowphase/collision.h>

#include <vector>

#include "tests/benchmarks/peer.hpp"

namespace axg::test {
namespace {

using Model = fcl::BVHModel<fcl::OBBRSSd>;

class FclPeer final : public Peer {
  public:
    explicit FclPeer(const Scene& scene) : scene_{scene} {
        for (const Mesh& mesh : scene.bodies) {
            auto model = std::make_shared<Model>();
            model->beginModel();
            for (const Triangle& t : mesh.triangles) {
                model->addTriangle(point(t.a), point(t.b), point(t.c));
            }
            model->endModel();
            models_.push_back(std::move(model));
        }
        placed_.resize(models_.size(), fcl::Transform3d::Identity());
    }
    [[nodiscard]] std::string name() const override { return "FCL OBBRSS"; }

    void cycle(std::span<const Pose> placed, std::span<std::uint8_t> hit) override {
        for (std::size_t body = 0; body < placed.size(); ++body) {
            for (int i = 0; i < 3; ++i) {
                for (int j = 0; j < 3; ++j) {
                    placed_[body].matrix()(i, j) = placed[body].r[i][j];
                }
                placed_[body].matrix()(i, 3) = placed[body].t[i];
            }
        }
        const fcl::CollisionRequestd request;  // one contact, no details
        for (std::size_t pair = 0; pair < scene_.pairs.size(); ++pair) {
            const ScenePair& p = scene_.pairs[pair];
            fcl::CollisionResultd result;
            hit[pair] = fcl::collide<double>(models_[p.a].get(), placed_[p.a], models_[p.b].get(),
                                             placed_[p.b], request, result) > 0
                            ? 1
                            : 0;
        }
    }

  private:
    static fcl::Vector3d point(Vec3f v) {
        const Vec3d w = widen(v);
        return {w.x, w.y, w.z};
    }
    const Scene& scene_;
    std::vector<std::shared_ptr<Model>> models_;
    std::vector<fcl::Transform3d, Eigen::aligned_allocator<fcl::Transform3d>> placed_;
};

}  // namespace

std::unique_ptr<Peer> make_fcl(const Scene& scene) {
    return std::make_unique<FclPeer>(scene);
}

}  // namespace axg::test
