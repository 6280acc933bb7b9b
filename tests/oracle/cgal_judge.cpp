// SPDX-License-Identifier: Apache-2.0
#include "tests/oracle/cgal_judge.hpp"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <vector>

namespace axg::test {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Eigen::Vector3d;
using Placement = Eigen::Isometry3d;

constexpr double kRoundingMm = 1e-6;
constexpr std::size_t kBlock = 16;  // triangles in a box of boxes: neighbours in most files

struct Aabb {
    Point low = Point::Constant(HUGE_VAL), high = Point::Constant(-HUGE_VAL);

    void add(const Point& p) {
        low = low.cwiseMin(p);
        high = high.cwiseMax(p);
    }
    void add(const Aabb& b) {
        low = low.cwiseMin(b.low);
        high = high.cwiseMax(b.high);
    }
    /// A lower bound of the distance of what lies in the two.
    [[nodiscard]] double gap(const Aabb& other) const { return std::sqrt(square_gap(other)); }
    [[nodiscard]] double square_gap(const Aabb& other) const {
        double sum = 0;
        for (int i = 0; i < 3; ++i) {
            const double apart =
                std::max(std::max(low(i) - other.high(i), other.low(i) - high(i)), 0.0);
            sum += apart * apart;
        }
        return sum;
    }
};

struct Surface {
    std::vector<std::array<Point, 3>> triangles;  // mesh frame, then machine coordinates
    std::vector<Aabb> boxes;                      // of each triangle
    std::vector<Aabb> blocks;                     // of each kBlock triangles
    Aabb box;
};

Point point_of(const Vec3f& v) {
    return {v.x, v.y, v.z};
}
Point point_of(const Vec3d& v) {
    return {v.x, v.y, v.z};
}

Placement placement_of(const Pose& pose) {
    Placement out = Placement::Identity();
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
            out.linear()(i, j) = pose.r[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)];
        }
        out.translation()(i) = pose.t[static_cast<std::size_t>(i)];
    }
    return out;
}

Placement motion_of(const Axis& axis, const Joint& joint, double q) {
    const Point direction = point_of(joint.direction);
    if (axis.kind == AxisKind::linear) {
        return Placement(Eigen::Translation3d(q * direction));
    }
    const Point pivot = point_of(joint.pivot_mm);
    return Eigen::Translation3d(pivot) * Eigen::AngleAxisd(q, direction.normalized()) *
           Eigen::Translation3d(-pivot);
}

Kernel::Triangle_3 triangle_of(const std::array<Point, 3>& t) {
    const auto p = [](const Point& x) { return Kernel::Point_3(x.x(), x.y(), x.z()); };
    return {p(t[0]), p(t[1]), p(t[2])};
}

}  // namespace

struct CgalJudge::Work {
    const Machine& machine;
    std::vector<Surface> meshes;  // of each body, in its own frame
    std::vector<Placement> at;    // mesh frame to machine coordinates at the zero pose
    std::vector<Surface> placed;
    std::vector<Placement> moved;
    double reach_mm = 0;

    void place(std::span<const double> position);
    void judge_pair(std::uint32_t index, Judgement& out) const;
    void judge_blocks(std::uint32_t index, std::size_t in_a, std::size_t in_b,
                      Judgement& out) const;
};

CgalJudge::CgalJudge(const Machine& machine, const MachineMeshes& meshes)
    : work_(new Work{machine, {}, {}, {}, {}, 0}) {
    for (std::size_t b = 0; b < machine.bodies.size(); ++b) {
        const Body& body = machine.bodies[b];
        const Mesh* mesh = &meshes.bodies[b];
        Placement at = placement_of(body.at);
        if (body.is_tool) {
            for (std::size_t t = 0; t < machine.tools.size(); ++t) {
                if (machine.tools[t].number == machine.first_tool) {
                    mesh = &meshes.tools[t];
                    at = at * placement_of(machine.tools[t].at);
                }
            }
        }
        Surface surface;
        for (const Triangle& t : mesh->triangles) {
            surface.triangles.push_back({point_of(t.a), point_of(t.b), point_of(t.c)});
            for (const Point& p : surface.triangles.back()) {
                work_->reach_mm = std::max(work_->reach_mm, (at * p).norm());
            }
        }
        work_->meshes.push_back(surface);
        work_->at.push_back(at);
    }
    // At the zero pose; linear axes carry a body away by no more than their travel, and a pivot
    // lies within the machine.
    double travel_mm = 0, pivot_mm = 0;
    for (const Axis& axis : machine.axes) {
        travel_mm +=
            axis.kind == AxisKind::linear ? std::max(std::abs(axis.min), std::abs(axis.max)) : 0;
    }
    for (const Body& body : machine.bodies) {
        pivot_mm = std::max(pivot_mm, point_of(body.joint.pivot_mm).norm());
    }
    work_->reach_mm = 2 * (work_->reach_mm + pivot_mm) + travel_mm;
    work_->placed = work_->meshes;
    work_->moved.resize(machine.bodies.size());
    for (Surface& surface : work_->placed) {
        surface.boxes.resize(surface.triangles.size());
        surface.blocks.resize((surface.triangles.size() + kBlock - 1) / kBlock);
    }
}

CgalJudge::~CgalJudge() = default;

double CgalJudge::reach_mm() const noexcept {
    return work_->reach_mm;
}

void CgalJudge::Work::place(std::span<const double> position) {
    for (std::size_t b = 0; b < machine.bodies.size(); ++b) {
        const Body& body = machine.bodies[b];
        moved[b] = body.parent == kNoIndex ? Placement::Identity() : moved[body.parent];
        if (body.joint.axis != kNoIndex) {
            moved[b] = moved[b] * motion_of(machine.axes[body.joint.axis], body.joint,
                                            position[body.joint.axis]);
        }
        const Placement to = moved[b] * at[b];
        Surface& out = placed[b];
        out.box = {};
        std::fill(out.blocks.begin(), out.blocks.end(), Aabb{});
        for (std::size_t i = 0; i < out.triangles.size(); ++i) {
            Aabb box;
            for (std::size_t k = 0; k < 3; ++k) {
                out.triangles[i][k] = to * meshes[b].triangles[i][k];
                box.add(out.triangles[i][k]);
            }
            out.boxes[i] = box;
            out.blocks[i / kBlock].add(box);
            out.box.add(box);
        }
    }
}

/// Two blocks of triangles whose boxes are nearer than what is known.
void CgalJudge::Work::judge_blocks(std::uint32_t index, std::size_t in_a, std::size_t in_b,
                                   Judgement& out) const {
    const Pair& pair = machine.pairs[index];
    const Surface &a = placed[pair.a], &b = placed[pair.b];
    const double near_mm = pair.margin_mm + kRoundingMm;
    const std::size_t end_a = std::min(in_a + kBlock, a.triangles.size());
    const std::size_t end_b = std::min(in_b + kBlock, b.triangles.size());
    for (std::size_t i = in_a; i < end_a; ++i) {
        for (std::size_t j = in_b; j < end_b; ++j) {
            const double square = a.boxes[i].square_gap(b.boxes[j]);
            if (square >= out.clear_mm * out.clear_mm) {
                continue;
            }
            if (square > near_mm * near_mm) {
                out.clear_mm = std::sqrt(square);  // boxes alone tell enough
                continue;
            }
            const Kernel::Triangle_3 s = triangle_of(a.triangles[i]);
            const Kernel::Triangle_3 t = triangle_of(b.triangles[j]);
            const bool touches = CGAL::do_intersect(s, t);
            const double distance = touches ? 0 : std::sqrt(CGAL::squared_distance(s, t));
            out.clear_mm = std::min(out.clear_mm, distance);
            if (touches || distance < pair.margin_mm - kRoundingMm) {
                out.touches = out.touches || touches;
                out.too_near = true;
                out.pair = index;
            }
        }
    }
}

void CgalJudge::Work::judge_pair(std::uint32_t index, Judgement& out) const {
    const Surface &a = placed[machine.pairs[index].a], &b = placed[machine.pairs[index].b];
    if (a.box.gap(b.box) >= out.clear_mm) {
        return;
    }
    for (std::size_t i = 0; i < a.blocks.size(); ++i) {
        if (a.blocks[i].gap(b.box) >= out.clear_mm) {
            continue;
        }
        for (std::size_t j = 0; j < b.blocks.size(); ++j) {
            if (a.blocks[i].gap(b.blocks[j]) < out.clear_mm) {
                judge_blocks(index, i * kBlock, j * kBlock, out);
            }
        }
    }
}

Judgement CgalJudge::judge(std::span<const double> position, double within_mm) {
    work_->place(position);
    Judgement out;
    out.clear_mm = within_mm;
    for (std::uint32_t i = 0; i < work_->machine.pairs.size(); ++i) {
        work_->judge_pair(i, out);
    }
    return out;
}

}  // namespace axg::test
