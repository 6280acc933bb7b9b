// SPDX-License-Identifier: Apache-2.0
// Bullet: GImpact trees, float, margin 0. Its algorithm finds all contacts; there is no first-only.
#include <BulletCollision/CollisionDispatch/btCollisionObjectWrapper.h>
#include <BulletCollision/Gimpact/btGImpactCollisionAlgorithm.h>
#include <BulletCollision/Gimpact/btGImpactShape.h>
#include <btBulletCollisionCommon.h>

#include <deque>
#include <vector>

#include "tests/benchmarks/peer.hpp"

namespace axg::test {
namespace {

/// Notes that there was a contact; keeps none.
struct Noted final : public btManifoldResult {
    Noted(const btCollisionObjectWrapper* a, const btCollisionObjectWrapper* b)
        : btManifoldResult(a, b) {}
    void addContactPoint(const btVector3& /*normal*/, const btVector3& /*point*/,
                         btScalar depth) override {
        contact = contact || depth <= btScalar(0);
    }
    bool contact = false;
};

class BulletPeer final : public Peer {
  public:
    explicit BulletPeer(const Scene& scene) : scene_{scene}, dispatcher_{&configuration_} {
        btGImpactCollisionAlgorithm::registerAlgorithm(&dispatcher_);
        for (const Mesh& mesh : scene.bodies) {
            btTriangleMesh& triangles = meshes_.emplace_back();
            for (const Triangle& t : mesh.triangles) {
                triangles.addTriangle(point(t.a), point(t.b), point(t.c));
            }
            btGImpactMeshShape& shape = shapes_.emplace_back(&triangles);
            shape.setMargin(0);
            shape.updateBound();
            objects_.emplace_back().setCollisionShape(&shape);
        }
    }
    [[nodiscard]] std::string name() const override { return "Bullet GImpact"; }

    void cycle(std::span<const Pose> placed, std::span<std::uint8_t> hit) override {
        for (std::size_t body = 0; body < placed.size(); ++body) {
            const Pose& p = placed[body];
            btTransform transform;
            transform.setBasis({scalar(p.r[0][0]), scalar(p.r[0][1]), scalar(p.r[0][2]),
                                scalar(p.r[1][0]), scalar(p.r[1][1]), scalar(p.r[1][2]),
                                scalar(p.r[2][0]), scalar(p.r[2][1]), scalar(p.r[2][2])});
            transform.setOrigin({scalar(p.t[0]), scalar(p.t[1]), scalar(p.t[2])});
            objects_[body].setWorldTransform(transform);
        }
        for (std::size_t pair = 0; pair < scene_.pairs.size(); ++pair) {
            hit[pair] = touch(objects_[scene_.pairs[pair].a], objects_[scene_.pairs[pair].b]);
        }
    }

  private:
    static btScalar scalar(double x) { return static_cast<btScalar>(x); }
    static btVector3 point(Vec3f v) { return {v.x, v.y, v.z}; }

    std::uint8_t touch(btCollisionObject& a, btCollisionObject& b) {
        const btCollisionObjectWrapper first{
            nullptr, a.getCollisionShape(), &a, a.getWorldTransform(), -1, -1};
        const btCollisionObjectWrapper second{
            nullptr, b.getCollisionShape(), &b, b.getWorldTransform(), -1, -1};
        btCollisionAlgorithm* const algorithm =
            dispatcher_.findAlgorithm(&first, &second, nullptr, BT_CONTACT_POINT_ALGORITHMS);
        Noted noted{&first, &second};
        algorithm->processCollision(&first, &second, info_, &noted);
        algorithm->~btCollisionAlgorithm();
        dispatcher_.freeCollisionAlgorithm(algorithm);
        return noted.contact ? 1 : 0;
    }

    const Scene& scene_;
    btDefaultCollisionConfiguration configuration_;
    btCollisionDispatcher dispatcher_;
    btDispatcherInfo info_;
    std::deque<btTriangleMesh> meshes_;
    std::deque<btGImpactMeshShape> shapes_;
    std::deque<btCollisionObject> objects_;
};

}  // namespace

std::unique_ptr<Peer> make_bullet(const Scene& scene) {
    return std::make_unique<BulletPeer>(scene);
}

}  // namespace axg::test
