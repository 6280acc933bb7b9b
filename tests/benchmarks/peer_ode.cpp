// SPDX-License-Identifier: Apache-2.0
// ODE: OPCODE trees of boxes; one contact asked for, marked unimportant, which ends the query
// early.
#include <ode/ode.h>

#include <vector>

#include "tests/benchmarks/peer.hpp"

namespace axg::test {
namespace {

class OdePeer final : public Peer {
  public:
    explicit OdePeer(const Scene& scene) : scene_{scene} {
        dInitODE2(0);
        dAllocateODEDataForThread(dAllocateMaskAll);
        vertices_.resize(scene.bodies.size());
        indices_.resize(scene.bodies.size());
        for (std::size_t body = 0; body < scene.bodies.size(); ++body) {
            for (const Triangle& t : scene.bodies[body].triangles) {
                for (const Vec3f& v : {t.a, t.b, t.c}) {
                    indices_[body].push_back(static_cast<dTriIndex>(vertices_[body].size() / 3));
                    vertices_[body].insert(vertices_[body].end(), {v.x, v.y, v.z});
                }
            }
            data_.push_back(dGeomTriMeshDataCreate());
            dGeomTriMeshDataBuildSingle(
                data_.back(), vertices_[body].data(), 3 * sizeof(float),
                static_cast<int>(vertices_[body].size() / 3), indices_[body].data(),
                static_cast<int>(indices_[body].size()), 3 * sizeof(dTriIndex));
            geoms_.push_back(dCreateTriMesh(nullptr, data_.back(), nullptr, nullptr, nullptr));
        }
    }
    ~OdePeer() override {
        for (std::size_t i = 0; i < geoms_.size(); ++i) {
            dGeomDestroy(geoms_[i]);
            dGeomTriMeshDataDestroy(data_[i]);
        }
        dCloseODE();
    }
    OdePeer(const OdePeer&) = delete;
    OdePeer& operator=(const OdePeer&) = delete;
    [[nodiscard]] std::string name() const override { return "ODE trimesh"; }

    void cycle(std::span<const Pose> placed, std::span<std::uint8_t> hit) override {
        for (std::size_t body = 0; body < placed.size(); ++body) {
            const Pose& p = placed[body];
            dGeomSetPosition(geoms_[body], real(p.t[0]), real(p.t[1]), real(p.t[2]));
            dMatrix3 rotation{};
            for (int i = 0; i < 3; ++i) {
                for (int j = 0; j < 3; ++j) {
                    rotation[4 * i + j] = real(p.r[i][j]);
                }
            }
            dGeomSetRotation(geoms_[body], rotation);
        }
        for (std::size_t pair = 0; pair < scene_.pairs.size(); ++pair) {
            const ScenePair& p = scene_.pairs[pair];
            dContactGeom contact;
            const int flags = static_cast<int>(1U | CONTACTS_UNIMPORTANT);
            hit[pair] =
                dCollide(geoms_[p.a], geoms_[p.b], flags, &contact, sizeof contact) > 0 ? 1 : 0;
        }
    }

  private:
    static dReal real(double x) { return static_cast<dReal>(x); }

    const Scene& scene_;
    std::vector<std::vector<float>> vertices_;
    std::vector<std::vector<dTriIndex>> indices_;
    std::vector<dTriMeshDataID> data_;
    std::vector<dGeomID> geoms_;
};

}  // namespace

std::unique_ptr<Peer> make_ode(const Scene& scene) {
    return std::make_unique<OdePeer>(scene);
}

}  // namespace axg::test
