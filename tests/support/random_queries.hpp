// SPDX-License-Identifier: Apache-2.0
// Random surfaces, placements and queries that every compiler and processor draws alike: integer
// arithmetic, and of floating point only what IEEE 754 rounds exactly (+ - * / sqrt). No
// distribution of <random>, whose results differ between libraries.
#pragma once

#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "core/collision/engine.hpp"
#include "core/mesh/mesh.hpp"
#include "hil_replay/lab/cases/draw.hpp"

namespace axg::test {

using lab::Draw;

inline Pose pose_of_quaternion(double w, double x, double y, double z) {
    const double n = std::sqrt(w * w + x * x + y * y + z * z);
    w /= n;
    x /= n;
    y /= n;
    z /= n;
    Pose p;
    const double r[3][3] = {{1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)},
                            {2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)},
                            {2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)}};
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
            p.r[i][j] = r[i][j];
        }
    }
    return p;
}

inline Pose random_rotation(Draw& draw) {
    for (;;) {
        const double q[4] = {draw.between(-1, 1), draw.between(-1, 1), draw.between(-1, 1),
                             draw.between(-1, 1)};
        const double n = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
        if (n > 0.01 && n <= 1) {
            return pose_of_quaternion(q[0], q[1], q[2], q[3]);
        }
    }
}

/// A closed lumpy ball of 12 n^2 triangles: the surface of a cube of n^3 cells blown up to about
/// `radius_mm`; every vertex is moved by its own number, so neighbours share it.
inline Mesh lumpy_ball(Draw& draw, std::uint32_t n, double radius_mm, double lump) {
    const std::uint64_t salt = draw.bits();
    const auto vertex = [&](const std::uint32_t(&i)[3]) {
        double p[3], length = 0;
        for (int k = 0; k < 3; ++k) {
            p[k] = 2.0 * i[k] / n - 1.0;
            length += p[k] * p[k];
        }
        Draw own(salt ^ (i[0] + 1000ULL * i[1] + 1000000ULL * i[2]));
        const double size = radius_mm * (1 + lump * (own.unit() - 0.5)) / std::sqrt(length);
        return Vec3f{static_cast<float>(size * p[0]), static_cast<float>(size * p[1]),
                     static_cast<float>(size * p[2])};
    };
    Mesh mesh{"ball", {}};
    for (unsigned axis = 0; axis < 3; ++axis) {
        for (std::uint32_t side : {0U, n}) {
            for (std::uint32_t u = 0; u < n; ++u) {
                for (std::uint32_t v = 0; v < n; ++v) {
                    const auto at = [&](std::uint32_t du, std::uint32_t dv) {
                        std::uint32_t i[3];
                        i[axis] = side;
                        i[(axis + 1) % 3] = u + du;
                        i[(axis + 2) % 3] = v + dv;
                        return vertex(i);
                    };
                    mesh.triangles.push_back({at(0, 0), at(1, 0), at(1, 1)});
                    mesh.triangles.push_back({at(0, 0), at(1, 1), at(0, 1)});
                }
            }
        }
    }
    return mesh;
}

/// A flat plate in the plane z = 0 of 2 nx ny triangles on whole coordinates: coplanar neighbours,
/// and needles when nx and ny differ much.
inline Mesh plate(std::uint32_t nx, std::uint32_t ny, float size_mm) {
    Mesh mesh{"plate", {}};
    const auto at = [&](std::uint32_t i, std::uint32_t j) {
        return Vec3f{size_mm * static_cast<float>(i) / static_cast<float>(nx) - size_mm / 2,
                     size_mm * static_cast<float>(j) / static_cast<float>(ny) - size_mm / 2, 0};
    };
    for (std::uint32_t i = 0; i < nx; ++i) {
        for (std::uint32_t j = 0; j < ny; ++j) {
            mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
            mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
        }
    }
    return mesh;
}

/// Surfaces of every size class: one leaf, two levels, three; round, flat, and thin as a needle.
inline std::vector<Mesh> random_surfaces(Draw& draw) {
    return {lumpy_ball(draw, 1, 20, 0.3),
            lumpy_ball(draw, 3, 40, 0.2),
            lumpy_ball(draw, 7, 60, 0.1),
            lumpy_ball(draw, 12, 50, 0.4),
            plate(1, 1, 64),
            plate(8, 8, 64),
            plate(100, 1, 64),
            lumpy_ball(draw, 2, 0.01, 0.3)};
}

/// Mostly near contact: bodies turned at random, or by quarter turns onto whole coordinates, where
/// edges and faces meet exactly.
inline Query random_query(Draw& draw, std::uint32_t mesh_count) {
    Query q;
    q.mesh_a = draw.below(mesh_count);
    q.mesh_b = draw.below(mesh_count);
    if (draw.below(4) == 0) {
        const bool turned = draw.below(2) == 0;
        q.pose = turned ? pose_of_quaternion(1, 0, 0, 1) : Pose{};  // rounds: not quite rigid
        for (double& t : q.pose.t) {
            t = 8.0 * (draw.below(17) - 8.0);
        }
    } else {
        q.pose = random_rotation(draw);
        const Pose direction = random_rotation(draw);
        const double away = draw.between(0, 130);
        for (int k = 0; k < 3; ++k) {
            q.pose.t[k] = away * direction.r[k][0];
        }
    }
    q.kind = static_cast<QueryKind>(draw.below(3));
    q.r_mm = q.kind == QueryKind::clearance ? draw.between(0.001, 60)
             : draw.below(3) == 0           ? 0
                                            : draw.between(0, 8);
    q.pose_error_mm = draw.below(8) == 0 ? draw.between(0, 0.01) : 0;
    return q;
}

/// FNV-1a over values, byte by byte from the lowest: the same on either byte order.
class Hash {
  public:
    void add(std::uint64_t value) {
        for (int i = 0; i < 8; ++i) {
            value_ = (value_ ^ (value & 0xffU)) * 0x100000001b3U;
            value >>= 8U;
        }
    }
    void add(const QueryResult& a, std::span<const TriangleIds> list) {
        add(static_cast<std::uint64_t>(a.status) << 8U | static_cast<std::uint64_t>(a.proof));
        add(a.touching);
        add(__builtin_bit_cast(std::uint64_t, a.clearance_mm));
        add(std::uint64_t{a.nearest.a} << 32U | a.nearest.b);
        add(std::uint64_t{a.node_pairs} << 32U | a.triangle_pairs);
        add(a.rechecks);
        for (const TriangleIds& ids : list) {
            add(std::uint64_t{ids.a} << 32U | ids.b);
        }
    }
    [[nodiscard]] std::uint64_t value() const { return value_; }

  private:
    std::uint64_t value_ = 0xcbf29ce484222325U;
};

}  // namespace axg::test
