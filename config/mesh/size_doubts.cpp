// SPDX-License-Identifier: Apache-2.0
#include "config/mesh/size_doubts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>

#include "config/mesh/load_meshes.hpp"
#include "config/mesh/mesh_faults.hpp"
#include "config/mesh/surface_box.hpp"
#include "config/mesh/survey_mesh.hpp"

namespace axg {
namespace {

double longest_side_mm(const SurfaceBox& box) {
    return longest_side(box.high_mm - box.low_mm);
}

std::string format_size(const SurfaceBox& box, double scale) {
    const Vec3d size = box.high_mm - box.low_mm;
    return fmt::format("{:.6g} x {:.6g} x {:.6g} mm", size.x * scale, size.y * scale,
                       size.z * scale);
}

double median_side_mm(const MachineMeshes& meshes) {
    std::vector<double> sides;
    for (const Mesh& mesh : meshes.bodies) {
        if (!mesh.triangles.empty()) {
            sides.push_back(longest_side_mm(box_of(mesh.triangles)));
        }
    }
    return median_side(sides);
}

constexpr std::array<LengthUnit, 4> kUnits{LengthUnit::mm, LengthUnit::inch, LengthUnit::m,
                                           LengthUnit::um};

double scale_to(const MeshSource& source, LengthUnit unit) {
    return scale_between(source.unit, unit);
}

/// The action of a fault: the unit that fits, the extents in it, and the key to accept the size.
std::string advice(const MeshSource& source, const SurfaceBox& box,
                   std::optional<LengthUnit> unit) {
    const std::string insist = "or set size_is_right: true if the surface is that small";
    return unit ? fmt::format("unit: {}, which makes it {}; {}", name_of(*unit),
                              format_size(box, scale_to(source, *unit)), insist)
                : "the right file and unit; " + insist;
}

/// The unit in which the longest side comes nearest to the median body's.
std::optional<LengthUnit> unit_near(const MeshSource& source, double side_mm, double median_mm) {
    std::optional<LengthUnit> best;
    double best_ratio = 0;
    for (const LengthUnit unit : kUnits) {
        const double side = side_mm * scale_to(source, unit);
        const double ratio = std::min(side, median_mm) / std::max(side, median_mm);
        if (side >= kLeastSideMm && ratio >= kLeastShareOfMedian && ratio > best_ratio) {
            best = unit;
            best_ratio = ratio;
        }
    }
    return best;
}

bool tip_fits(double tip_mm, double length_mm) {
    return std::fabs(tip_mm - length_mm) <=
           std::max(kTipToleranceMm, kTipToleranceRelative * length_mm);
}

void doubt_body(const Body& body, const Mesh& mesh, double median_mm,
                std::vector<ConfigFault>& faults) {
    const MeshSource& source = body.mesh;
    if (source.size_is_right || source.file.empty() || mesh.triangles.empty()) {
        return;
    }
    const SurfaceBox box = box_of(mesh.triangles);
    const double side = longest_side_mm(box);
    if (side >= kLeastSideMm && side >= kLeastShareOfMedian * median_mm) {
        return;
    }
    const std::string share =
        side < kLeastShareOfMedian * median_mm
            ? fmt::format(", {:.4g} times smaller than the median body ({:.6g} mm)",
                          median_mm / side, median_mm)
            : "";
    faults.push_back({source.where, "bodies." + body.name + ".mesh.unit",
                      fmt::format("{}: {} in {}{}", printable(source.file), format_size(box, 1),
                                  name_of(source.unit), share),
                      advice(source, box, unit_near(source, side, median_mm))});
}

/// Above all the tip: a tool of which 0.14 mm are left contradicts its own length of 140 mm.
void doubt_tool(const Tool& tool, const Mesh& mesh, std::vector<ConfigFault>& faults) {
    const MeshSource& source = tool.mesh;
    if (source.size_is_right || mesh.triangles.empty()) {
        return;
    }
    const SurfaceBox box = box_of(mesh.triangles, source.turns ? Pose{} : tool.at);
    const double tip_mm = -box.low_mm.z;
    const bool is_file = !source.file.empty();
    if (tip_fits(tip_mm, tool.length_mm) && !(is_file && longest_side_mm(box) < kLeastSideMm)) {
        return;
    }
    const std::string key = fmt::format("tools.{}", tool.number);
    const std::string tip = fmt::format(
        "a tip {:.6g} mm below the spindle nose, and length_mm: {:.6g}", tip_mm, tool.length_mm);
    if (!is_file) {
        faults.push_back({source.where, key + ".length_mm", tip,
                          "the length to 1 % or 1 mm; check length_mm, the surface and its "
                          "position, or set size_is_right: true if the tip is elsewhere"});
        return;
    }
    const auto* const fitting = std::find_if(kUnits.begin(), kUnits.end(), [&](LengthUnit unit) {
        return unit != source.unit && tip_fits(tip_mm * scale_to(source, unit), tool.length_mm);
    });
    faults.push_back({source.where, key + ".mesh.unit",
                      fmt::format("{}: {} in {}: {}", printable(source.file), format_size(box, 1),
                                  name_of(source.unit), tip),
                      fitting != kUnits.end()
                          ? advice(source, box, *fitting)
                          : "the length to 1 % or 1 mm; check length_mm, the file, its unit and "
                            "its position, or set size_is_right: true if the tip is elsewhere"});
}

}  // namespace

std::vector<ConfigFault> doubt_sizes(const Machine& machine, const MachineMeshes& meshes) {
    std::vector<ConfigFault> faults;
    const double median_mm = median_side_mm(meshes);
    for (std::size_t i = 0; i < machine.bodies.size(); ++i) {
        doubt_body(machine.bodies[i], meshes.bodies[i], median_mm, faults);
    }
    for (std::size_t i = 0; i < machine.tools.size(); ++i) {
        doubt_tool(machine.tools[i], meshes.tools[i], faults);
    }
    return faults;
}

}  // namespace axg
