// SPDX-License-Identifier: Apache-2.0
// One volume a body, as simple guards have it: the box of the mesh along its own axes (fifteen
// axes a pair), or the sphere around that box's centre. Double. They miss no contact, and call a
// contact what is still far apart.
#include <algorithm>
#include <cmath>
#include <vector>

#include "core/machine/kinematics.hpp"
#include "tests/benchmarks/peer.hpp"

namespace axg::test {
namespace {

struct Volume {
    Vec3d centre, half;
    double radius = 0;
};

Volume volume_of(const Mesh& mesh) {
    Vec3d low = widen(mesh.triangles.front().a), high = low;
    const auto each = [&mesh](const auto& visit) {
        for (const Triangle& t : mesh.triangles) {
            for (const Vec3f& v : {t.a, t.b, t.c}) {
                visit(widen(v));
            }
        }
    };
    each([&](const Vec3d& v) {
        low = {std::min(low.x, v.x), std::min(low.y, v.y), std::min(low.z, v.z)};
        high = {std::max(high.x, v.x), std::max(high.y, v.y), std::max(high.z, v.z)};
    });
    Volume out{.centre = 0.5 * (low + high), .half = 0.5 * (high - low)};
    each([&](const Vec3d& v) {
        const Vec3d from = v - out.centre;
        out.radius = std::max(out.radius, std::sqrt(dot(from, from)));
    });
    return out;
}

/// b's centre in a's frame, with a's own centre as origin.
Vec3d between(const Volume& a, const Volume& b, const Pose& b_in_a) {
    const double c[3] = {b.centre.x, b.centre.y, b.centre.z};
    double out[3];
    for (int i = 0; i < 3; ++i) {
        out[i] =
            b_in_a.r[i][0] * c[0] + b_in_a.r[i][1] * c[1] + b_in_a.r[i][2] * c[2] + b_in_a.t[i];
    }
    return Vec3d{out[0], out[1], out[2]} - a.centre;
}

bool spheres_touch(const Volume& a, const Volume& b, const Pose& b_in_a) {
    const Vec3d d = between(a, b, b_in_a);
    return dot(d, d) <= (a.radius + b.radius) * (a.radius + b.radius);
}

/// Source: Gottschalk, Lin, Manocha, "OBBTree", SIGGRAPH 1996.
bool boxes_touch(const Volume& a, const Volume& b, const Pose& b_in_a) {
    const Vec3d d3 = between(a, b, b_in_a);
    const double d[3] = {d3.x, d3.y, d3.z}, ha[3] = {a.half.x, a.half.y, a.half.z},
                 hb[3] = {b.half.x, b.half.y, b.half.z};
    double size[3][3];
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
            size[i][j] = std::fabs(b_in_a.r[i][j]);
        }
    }
    bool apart = false;
    for (int i = 0; i < 3; ++i) {
        apart = apart || std::fabs(d[i]) >
                             ha[i] + size[i][0] * hb[0] + size[i][1] * hb[1] + size[i][2] * hb[2];
        const double along = d[0] * b_in_a.r[0][i] + d[1] * b_in_a.r[1][i] + d[2] * b_in_a.r[2][i];
        apart = apart || std::fabs(along) >
                             hb[i] + size[0][i] * ha[0] + size[1][i] * ha[1] + size[2][i] * ha[2];
    }
    for (int i = 0; i < 3 && !apart; ++i) {
        const int i1 = (i + 1) % 3, i2 = (i + 2) % 3;
        for (int j = 0; j < 3; ++j) {
            const int j1 = (j + 1) % 3, j2 = (j + 2) % 3;
            const double along = d[i2] * b_in_a.r[i1][j] - d[i1] * b_in_a.r[i2][j];
            apart = apart || std::fabs(along) > ha[i1] * size[i2][j] + ha[i2] * size[i1][j] +
                                                    hb[j1] * size[i][j2] + hb[j2] * size[i][j1];
        }
    }
    return !apart;
}

using Touch = bool (*)(const Volume& a, const Volume& b, const Pose& b_in_a);

class VolumePeer final : public Peer {
  public:
    VolumePeer(const Scene& scene, std::string name, Touch touch)
        : scene_{scene}, name_{std::move(name)}, touch_{touch} {
        for (const Mesh& mesh : scene.bodies) {
            volumes_.push_back(volume_of(mesh));
        }
    }
    [[nodiscard]] std::string name() const override { return name_; }

    void cycle(std::span<const Pose> placed, std::span<std::uint8_t> hit) override {
        for (std::size_t pair = 0; pair < scene_.pairs.size(); ++pair) {
            const ScenePair& p = scene_.pairs[pair];
            const Pose b_in_a = relative_pose(placed[p.b], placed[p.a]);
            hit[pair] = touch_(volumes_[p.a], volumes_[p.b], b_in_a) ? 1 : 0;
        }
    }

  private:
    const Scene& scene_;
    std::string name_;
    Touch touch_;
    std::vector<Volume> volumes_;
};

}  // namespace

std::unique_ptr<Peer> make_boxes(const Scene& scene) {
    return std::make_unique<VolumePeer>(scene, "box a body", &boxes_touch);
}

std::unique_ptr<Peer> make_spheres(const Scene& scene) {
    return std::make_unique<VolumePeer>(scene, "sphere a body", &spheres_touch);
}

}  // namespace axg::test
