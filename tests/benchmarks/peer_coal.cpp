// SPDX-License-Identifier: Apache-2.0
// Coal, the successor of hpp-fcl: a tree of OBBRSS a body, double, first contact ends the query.
// From PyPI, because Debian has no package of it: tests/benchmarks/requirements.txt.
#include <coal/BVH/BVH_model.h>
#include <coal/collision.h>

#include <memory>
#include <vector>

#include "tests/benchmarks/peer.hpp"

namespace axg::test {
namespace {

using Model = coal::BVHModel<coal::OBBRSS>;

class CoalPeer final : public Peer {
  public:
    explicit CoalPeer(const Scene& scene) : scene_{scene}, placed_(scene.bodies.size()) {
        for (const Mesh& mesh : scene.bodies) {
            auto model = std::make_shared<Model>();
            model->beginModel();
            for (const Triangle& t : mesh.triangles) {
                model->addTriangle(point(t.a), point(t.b), point(t.c));
            }
            model->endModel();
            models_.push_back(std::move(model));
        }
    }
    [[nodiscard]] std::string name() const override { return "Coal OBBRSS"; }

    void cycle(std::span<const Pose> placed, std::span<std::uint8_t> hit) override {
        for (std::size_t body = 0; body < placed.size(); ++body) {
            coal::Matrix3s rotation;
            coal::Vec3s translation;
            for (int i = 0; i < 3; ++i) {
                for (int j = 0; j < 3; ++j) {
                    rotation(i, j) = placed[body].r[i][j];
                }
                translation[i] = placed[body].t[i];
            }
            placed_[body].setTransform(rotation, translation);
        }
        const coal::CollisionRequest request(coal::NO_REQUEST, 1);
        for (std::size_t pair = 0; pair < scene_.pairs.size(); ++pair) {
            const ScenePair& p = scene_.pairs[pair];
            coal::CollisionResult result;
            hit[pair] = coal::collide(models_[p.a].get(), placed_[p.a], models_[p.b].get(),
                                      placed_[p.b], request, result) > 0
                            ? 1
                            : 0;
        }
    }

  private:
    static coal::Vec3s point(Vec3f v) {
        const Vec3d w = widen(v);
        return {w.x, w.y, w.z};
    }
    const Scene& scene_;
    std::vector<std::shared_ptr<Model>> models_;
    std::vector<coal::Transform3s> placed_;
};

}  // namespace

std::unique_ptr<Peer> make_coal(const Scene& scene) {
    return std::make_unique<CoalPeer>(scene);
}

}  // namespace axg::test
