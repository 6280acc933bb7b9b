// SPDX-License-Identifier: Apache-2.0
// Small bodies of awkward triangles, poses that bring two of them near contact, and the exact
// distances of all their triangles. Header-only: the tests that use it have GMP.
#pragma once

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>
#include <vector>

#include "core/collision/engine.hpp"
#include "core/mesh/mesh.hpp"
#include "tests/support/exact_distance.hpp"
#include "tests/support/triangle_cases.hpp"

namespace axg::test {

enum class BodyKind { soup, surface, slivers, grid, single, far_away, subnormal, many };

inline Vec3f random_vertex(std::mt19937_64& random, double size) {
    const auto x = [&] { return static_cast<float>(between(random, -size, size)); };
    return {x(), x(), x()};
}

inline Vec3f on_grid(std::mt19937_64& random, unsigned steps, float step) {
    const auto x = [&] {
        return step *
               static_cast<float>(static_cast<int>(random() % steps) - static_cast<int>(steps / 2));
    };
    return {x(), x(), x()};
}

/// A bumpy surface: neighbours share their vertices.
inline std::vector<Triangle> bumps(std::mt19937_64& random, double size) {
    constexpr unsigned kSide = 6;
    Vec3f p[kSide][kSide];
    for (unsigned i = 0; i < kSide; ++i) {
        for (unsigned j = 0; j < kSide; ++j) {
            p[i][j] = {static_cast<float>(size * (i / 2.5 - 1)),
                       static_cast<float>(size * (j / 2.5 - 1)),
                       static_cast<float>(size * between(random, 0, 0.2))};
        }
    }
    std::vector<Triangle> out;
    for (unsigned i = 0; i + 1 < kSide; ++i) {
        for (unsigned j = 0; j + 1 < kSide; ++j) {
            out.push_back({p[i][j], p[i + 1][j], p[i][j + 1]});
            out.push_back({p[i + 1][j], p[i + 1][j + 1], p[i][j + 1]});
        }
    }
    return out;
}

inline Triangle one_triangle(std::mt19937_64& random, BodyKind kind, double size) {
    if (kind == BodyKind::grid) {
        return {on_grid(random, 9, 1), on_grid(random, 9, 1), on_grid(random, 9, 1)};
    }
    if (kind == BodyKind::subnormal) {
        return {on_grid(random, 7, 0x1p-149F), on_grid(random, 7, 0x1p-149F),
                on_grid(random, 7, 0x1p-149F)};
    }
    const Vec3f at = random_vertex(random, size);
    const double own = size * std::exp2(between(random, -6, 0));
    Triangle t{at, at + random_vertex(random, own), at + random_vertex(random, own)};
    if (kind == BodyKind::slivers) {
        const unsigned how = random() % 4;  // thin, thin to the last bits, a segment, a point
        const float thin = how == 0 ? 1e-3F : 1e-6F;
        t.c = how < 2 ? t.a + 0.5F * (t.b - t.a) + thin * (t.c - t.a) : t.b;
        t.b = how == 3 ? t.a : t.b;
        t.c = how == 3 ? t.a : t.c;
    }
    return t;
}

inline Mesh make_body(std::mt19937_64& random, BodyKind kind) {
    const double size = std::exp2(between(random, -2, 8));
    unsigned count = 1 + static_cast<unsigned>(random() % (1U << (random() % 7)));
    count = kind == BodyKind::single ? 1
            : kind == BodyKind::many ? 33 + static_cast<unsigned>(random() % 1500)
                                     : count;
    Mesh mesh{"body", {}};
    if (kind == BodyKind::surface) {
        mesh.triangles = bumps(random, size);
    }
    for (unsigned i = 0; kind != BodyKind::surface && i < count; ++i) {
        mesh.triangles.push_back(one_triangle(random, kind, size));
    }
    if (kind == BodyKind::far_away) {
        const Vec3f by = random_vertex(random, 9.9e4);
        for (Triangle& t : mesh.triangles) {
            t = {t.a + by, t.b + by, t.c + by};
        }
    }
    return mesh;
}

/// A pose that puts a vertex of a at most about a gap, a power of two from 2^-46 to 2^4 mm of
/// either sign, above the outermost vertex of b in some direction.
inline Pose pose_near(std::mt19937_64& random, const Mesh& a, const Mesh& b, BodyKind kind) {
    Pose pose;
    const bool turned = kind == BodyKind::subnormal ||
                        (kind == BodyKind::grid ? random() % 4 == 0 : random() % 8 != 0);
    if (turned) {
        pose = random_turn(random);
    }
    if (turned && random() % 4 == 0) {  // as far from rigid as the engine takes
        for (auto& row : pose.r) {
            for (double& x : row) {
                x += between(random, -1, 1) * 0.25 * kRigidDefectMax;
            }
        }
    }
    if (kind == BodyKind::subnormal) {
        for (double& x : pose.t) {
            x = 0x1p-149 * (static_cast<double>(random() % 9) - 4);
        }
        return pose;
    }
    const Vec3f aim = random_vertex(random, 1);
    const Vec3d n = random() % 2 == 0 ? Vec3d{0, 0, 1} : widen(aim);
    const auto outermost = [&n](const Mesh& mesh, const Pose& by, double sign) {
        Vec3d best{};
        double most = -HUGE_VAL;
        for (const Triangle& t : mesh.triangles) {
            for (const Vec3f& v : {t.a, t.b, t.c}) {
                const Vec3d p = rotate(by, widen(v));
                if (sign * dot(n, p) > most) {
                    most = sign * dot(n, p);
                    best = p;
                }
            }
        }
        return best;
    };
    const Vec3d from = outermost(a, pose, -1), to = outermost(b, Pose{}, 1);
    double gap = std::ldexp(1.0, static_cast<int>(random() % 51) - 46);
    gap *= random() % 4 == 0 ? -1 : 1;
    gap = random() % 4 == 0 ? 0 : gap;
    const double shift = random() % 3 == 0 ? 0 : 1;
    const Vec3d t = to - from + (gap / std::sqrt(dot(n, n))) * n;
    pose.t[0] = t.x + shift * between(random, -1, 1) * 0.1;
    pose.t[1] = t.y + shift * between(random, -1, 1) * 0.1;
    pose.t[2] = t.z;
    return pose;
}

struct ExactPair {
    TriangleIds ids;
    ExactSquare square;
};

/// All pairs of triangles that may be within `near_mm`, and the distance of the surfaces. Boxes in
/// double, wrong by less than 1e-6 mm, leave out what is farther; where all is, the distance is
/// that of the pair whose boxes are nearest, and stands for "more than near_mm".
class ExactScene {
  public:
    ExactScene(const Mesh& a, const Mesh& b, const Pose& pose, double near_mm) {
        std::vector<ExactTriangle> exact_a, exact_b;
        for (const Triangle& t : a.triangles) {
            exact_a.push_back(placed(pose, t));
        }
        for (const Triangle& t : b.triangles) {
            exact_b.push_back(exact(t));
        }
        for (std::uint32_t i = 0; i < exact_a.size(); ++i) {
            for (std::uint32_t j = 0; j < exact_b.size(); ++j) {
                if (boxes_gap_mm(pose, a.triangles[i], b.triangles[j]) > near_mm + 1e-6) {
                    continue;
                }
                ExactSquare square = squared_distance(exact_a[i], exact_b[j]);
                if (near_.empty() || square.less_than(distance_)) {
                    distance_ = square;
                }
                near_.push_back({{i, j}, std::move(square)});
            }
        }
        if (near_.empty()) {
            distance_ = {Dyadic(near_mm + 1) * Dyadic(near_mm + 1), Dyadic(1.0)};
        }
        distance_mm_ = distance_.mm();
    }

    [[nodiscard]] const std::vector<ExactPair>& near() const { return near_; }
    [[nodiscard]] const ExactSquare& distance() const { return distance_; }
    [[nodiscard]] double distance_mm() const { return distance_mm_; }

  private:
    static double boxes_gap_mm(const Pose& pose, const Triangle& a, const Triangle& b) {
        const Vec3d pa[3] = {apply(pose, widen(a.a)), apply(pose, widen(a.b)),
                             apply(pose, widen(a.c))};
        const Vec3d pb[3] = {widen(b.a), widen(b.b), widen(b.c)};
        const auto along = [&](double Vec3d::*k) {
            const auto [low_a, high_a] = std::minmax({pa[0].*k, pa[1].*k, pa[2].*k});
            const auto [low_b, high_b] = std::minmax({pb[0].*k, pb[1].*k, pb[2].*k});
            return std::max(low_a - high_b, low_b - high_a);
        };
        return std::max({along(&Vec3d::x), along(&Vec3d::y), along(&Vec3d::z)});
    }

    std::vector<ExactPair> near_;
    ExactSquare distance_;
    double distance_mm_ = 0;
};

}  // namespace axg::test
