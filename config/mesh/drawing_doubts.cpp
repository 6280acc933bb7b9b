// SPDX-License-Identifier: Apache-2.0
#include "config/mesh/drawing_doubts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "config/mesh/load_meshes.hpp"
#include "config/mesh/surface_box.hpp"
#include "config/mesh/survey_mesh.hpp"
#include "config/text/quote_text.hpp"
#include "core/machine/kinematics.hpp"
#include "core/mesh/mesh_check.hpp"
#include "core/mesh/place_triangles.hpp"
#include "core/mesh/shape.hpp"

namespace axg {
namespace {

constexpr const char* kAccept = "or set size_is_right: true";

/// How near two lengths are: 1 if equal, towards 0 the more they differ.
double nearness(double a, double b) {
    return std::min(a, b) / std::max(a, b);
}

Vec3d size_of(const SurfaceBox& box) {
    return box.high_mm - box.low_mm;
}

/// Distance of two boxes along the axis that parts them most; 0: they overlap.
double gap_between(const SurfaceBox& a, const SurfaceBox& b) {
    return std::max({a.low_mm.x - b.high_mm.x, b.low_mm.x - a.high_mm.x, a.low_mm.y - b.high_mm.y,
                     b.low_mm.y - a.high_mm.y, a.low_mm.z - b.high_mm.z, b.low_mm.z - a.high_mm.z,
                     0.0});
}

/// The parts of a tool along z, from the tip up: a surface covers the heights that it has.
std::vector<std::pair<double, double>> pieces_of(std::span<const Triangle> triangles,
                                                 const Pose& at) {
    std::vector<std::pair<double, double>> heights;
    for (const Triangle& triangle : triangles) {
        const double a = apply(at, widen(triangle.a)).z;
        const double b = apply(at, widen(triangle.b)).z;
        const double c = apply(at, widen(triangle.c)).z;
        heights.emplace_back(std::min({a, b, c}), std::max({a, b, c}));
    }
    std::sort(heights.begin(), heights.end());
    std::vector<std::pair<double, double>> pieces;
    for (const auto& [low, high] : heights) {
        if (pieces.empty() || low > pieces.back().second + kDrawnApartMmMax) {
            pieces.emplace_back(low, high);
        } else {
            pieces.back().second = std::max(pieces.back().second, high);
        }
    }
    return pieces;
}

class DrawingDoubts {
  public:
    DrawingDoubts(const Machine& machine, const MachineMeshes& meshes)
        : machine_(machine), meshes_(meshes), placed_(machine.bodies.size()) {
        const std::vector<double> zero(machine.axes.size(), 0.0);
        place_bodies(machine, zero, placed_);
    }

    std::vector<std::string> run() {
        for (const Tool& tool : machine_.tools) {
            const auto index = static_cast<std::size_t>(&tool - machine_.tools.data());
            if (!tool.mesh.size_is_right && !meshes_.tools[index].triangles.empty()) {
                doubt_tool(tool, meshes_.tools[index].triangles);
            }
        }
        doubt_bodies();
        return std::move(lines_);
    }

  private:
    void add(const std::string& where, const std::string& key, const std::string& text) {
        lines_.push_back(fmt::format("{}: {}: {}", where, key, text));
    }

    void doubt_tool(const Tool& tool, std::span<const Triangle> triangles) {
        const std::string key = fmt::format("tools.{}", tool.number);
        const Pose at = tool.mesh.turns ? Pose{} : tool.at;
        const auto pieces = pieces_of(triangles, at);
        const double top_mm = pieces.back().second;
        if (top_mm > kDrawnApartMmMax && may_be_in_spindle(triangles, at)) {
            add(tool.mesh.where, key,
                fmt::format("{} reaches {:.6g} mm above the spindle nose, into the spindle. A tool "
                            "hangs below z = 0: correct at_mm or the heights, {}.",
                            highest_section(tool, at), top_mm, kAccept));
        }
        for (std::size_t i = 0; i < pieces.size(); ++i) {
            const bool is_last = i + 1 == pieces.size();
            const double next_mm = is_last ? 0 : pieces[i + 1].first;
            if (next_mm > pieces[i].second + kDrawnApartMmMax) {
                add(tool.mesh.where, key,
                    fmt::format("nothing from {:.6g} to {:.6g} mm: {}. Correct at_mm or the "
                                "heights, {}.",
                                pieces[i].second, next_mm,
                                is_last ? "the tool does not reach the spindle nose"
                                        : "the tool is in two parts",
                                kAccept));
            }
        }
        doubt_hidden(tool, key, at);
    }

    /// The tool body; null: none, or nothing carries it.
    [[nodiscard]] const Body* carried_tool_body() const {
        const auto holder = std::find_if(machine_.bodies.begin(), machine_.bodies.end(),
                                         [](const Body& body) { return body.is_tool; });
        return holder == machine_.bodies.end() || holder->parent == kNoIndex ? nullptr : &*holder;
    }

    /// From the frame of the tool body to that of the body that carries it.
    [[nodiscard]] Pose to_spindle(const Body& holder) const {
        const auto place = static_cast<std::size_t>(&holder - machine_.bodies.data());
        return relative_pose(placed_[place], placed_[holder.parent]);
    }

    /// False: the boxes of the tool and of the body that carries it do not overlap, because that
    /// body ends above z = 0 of the tool.
    [[nodiscard]] bool may_be_in_spindle(std::span<const Triangle> triangles,
                                         const Pose& at) const {
        const Body* const holder = carried_tool_body();
        if (holder == nullptr || meshes_.bodies[holder->parent].triangles.empty()) {
            return true;
        }
        const SurfaceBox spindle = box_of(meshes_.bodies[holder->parent].triangles);
        const SurfaceBox tool = box_of(triangles, compose(to_spindle(*holder), at));
        const Vec3d from_low = spindle.high_mm - tool.low_mm;
        const Vec3d from_high = tool.high_mm - spindle.low_mm;
        return std::min({from_low.x, from_low.y, from_low.z, from_high.x, from_high.y,
                         from_high.z}) > kDrawnApartMmMax;
    }

    static std::string highest_section(const Tool& tool, const Pose& at) {
        std::string names;
        for (const Shape& section : tool.mesh.shapes) {
            const bool is_high =
                !section.name.empty() &&
                box_of(triangles_of(section).triangles, at).high_mm.z > kDrawnApartMmMax;
            names += is_high ? (names.empty() ? "section " : ", ") + section.name : "";
        }
        return names.empty() ? "the surface" : names;
    }

    /// A section inside the body that carries the tool is in no pair that could see it.
    void doubt_hidden(const Tool& tool, const std::string& key, const Pose& at) {
        const Body* const holder = carried_tool_body();
        if (holder == nullptr) {
            return;
        }
        const std::vector<Triangle>& spindle = meshes_.bodies[holder->parent].triangles;
        const SurfaceBox outer = box_of(spindle);
        for (const Shape& section : tool.mesh.shapes) {
            std::vector<Triangle> both = triangles_of(section).triangles;
            place_triangles(at, both);
            if (section.name.empty() || box_of(both).high_mm.z > kDrawnApartMmMax) {
                continue;  // the nose is judged above
            }
            place_triangles(to_spindle(*holder), both);
            const SurfaceBox inner = box_of(both);
            const Vec3d below = inner.low_mm - outer.low_mm, above = outer.high_mm - inner.high_mm;
            if (spindle.empty() ||
                std::min({below.x, below.y, below.z, above.x, above.y, above.z}) < 0) {
                continue;
            }
            both.insert(both.end(), spindle.begin(), spindle.end());
            if (check_mesh(both).nested_shells > check_mesh(spindle).nested_shells) {
                add(tool.mesh.where, key,
                    fmt::format("section {} is inside body {}, which carries the tool. Correct "
                                "its at_mm, or that of the tool body, {}.",
                                section.name, machine_.bodies[holder->parent].name, kAccept));
            }
        }
    }

    void doubt_bodies() {
        std::vector<BodySize> sizes;
        std::vector<SurfaceBox> boxes;
        for (std::size_t i = 0; i < machine_.bodies.size(); ++i) {
            const Body& body = machine_.bodies[i];
            const std::vector<Triangle>& triangles = meshes_.bodies[i].triangles;
            sizes.push_back({body.mesh.file, body.mesh.unit, size_of(box_of(triangles)),
                             body.parent, !body.mesh.size_is_right && !body.mesh.file.empty()});
            boxes.push_back(box_of(triangles, placed_[i]));
        }
        const std::vector<std::string> doubts = doubt_units(sizes);
        for (std::uint32_t i = 0; i < machine_.bodies.size(); ++i) {
            const Body& body = machine_.bodies[i];
            if (!doubts[i].empty()) {
                add(body.mesh.where, "bodies." + body.name + ".mesh",
                    fmt::format("{}. Correct unit, {}.", doubts[i], kAccept));
            } else if (!body.mesh.size_is_right) {
                doubt_join(i, boxes);
            }
        }
    }

    /// Its parent has a surface, and neither that one's box nor another's is near.
    void doubt_join(std::uint32_t index, const std::vector<SurfaceBox>& boxes) {
        const auto has_surface = [this](std::uint32_t i) {
            return !meshes_.bodies[i].triangles.empty();
        };
        const Body& body = machine_.bodies[index];
        if (!has_surface(index) || body.parent == kNoIndex || !has_surface(body.parent)) {
            return;
        }
        double gap_mm = INFINITY;
        for (std::uint32_t i = 0; i < boxes.size(); ++i) {
            if (i != index && has_surface(i)) {
                gap_mm = std::min(gap_mm, gap_between(boxes[index], boxes[i]));
            }
        }
        const double side_mm = longest_side(size_of(boxes[index]));
        if (gap_mm > std::max(kDrawnApartMmMax, kApartShareMax * side_mm)) {
            add(body.mesh.where, "bodies." + body.name,
                fmt::format("at the zero pose it is joined to nothing: {:.6g} mm or more from {}, "
                            "which carries it, and from every other body. Correct at_mm or the "
                            "unit, {}.",
                            gap_mm, machine_.bodies[body.parent].name, kAccept));
        }
    }

    const Machine& machine_;
    const MachineMeshes& meshes_;
    std::vector<Pose> placed_;  // [bodies] mesh frame to machine coordinates at the zero pose
    std::vector<std::string> lines_;
};

}  // namespace

std::vector<std::string> doubt_units(std::span<const BodySize> sizes) {
    std::vector<double> sides;
    for (const BodySize& one : sizes) {
        if (one.size_mm != Vec3d{}) {
            sides.push_back(longest_side(one.size_mm));
        }
    }
    const double median_mm = median_side(sides);
    std::vector<std::string> doubts(sizes.size());
    for (std::size_t i = 0; i < sizes.size(); ++i) {
        const BodySize& one = sizes[i];
        const double side_mm = longest_side(one.size_mm);
        if (!one.is_doubtful || side_mm == 0 || nearness(side_mm, median_mm) * kOddRatioMin > 1) {
            continue;
        }
        const LengthUnit other = one.unit == LengthUnit::inch ? LengthUnit::mm : LengthUnit::inch;
        const double fitting_mm = side_mm * scale_between(one.unit, other);
        const double parent_mm =
            one.parent == kNoIndex ? 0 : longest_side(sizes[one.parent].size_mm);
        const auto is_nearer = [side_mm, fitting_mm](double to_mm) {
            return nearness(fitting_mm, to_mm) > nearness(side_mm, to_mm);
        };
        if (!is_nearer(median_mm) || (parent_mm > 0 && !is_nearer(parent_mm))) {
            continue;
        }
        doubts[i] = fmt::format(
            "{}: {:.6g} mm, {:.3g} times {} than the median body ({:.6g} mm); in {} {:.6g} mm",
            escaped(one.name), side_mm, 1 / nearness(side_mm, median_mm),
            side_mm < median_mm ? "smaller" : "larger", median_mm, name_of(other), fitting_mm);
    }
    return doubts;
}

std::vector<std::string> doubt_drawings(const Machine& machine, const MachineMeshes& meshes) {
    return DrawingDoubts(machine, meshes).run();
}

}  // namespace axg
