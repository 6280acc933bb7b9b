// SPDX-License-Identifier: Apache-2.0
#include "config/mesh/load_meshes.hpp"

#include <fmt/format.h>
#include <sha2.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "config/mesh/mesh_faults.hpp"
#include "config/mesh/prune.hpp"
#include "config/mesh/survey_mesh.hpp"
#include "config/text/open_beneath.hpp"
#include "core/mesh/mesh_check.hpp"
#include "core/mesh/place_triangles.hpp"
#include "core/mesh/shape.hpp"
#include "core/mesh/stl.hpp"
#include "core/mesh/swept_profile.hpp"

namespace axg {
namespace {

constexpr double kSizeToleranceRelative =
    0.01;  // size_mm is for the wrong unit or file, not for tolerances

std::string sha256_hex(const std::vector<std::byte>& bytes) {
    SHA2_CTX context;
    SHA256Init(&context);
    SHA256Update(&context, reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
    std::array<std::uint8_t, SHA256_DIGEST_LENGTH> digest{};
    SHA256Final(digest.data(), &context);
    std::string hex;
    for (const std::uint8_t byte : digest) {
        hex += fmt::format("{:02x}", byte);
    }
    return hex;
}

/// The source of one surface, for its messages, and the lists for its faults and notes.
struct Place {
    std::string key;   // bodies.a.mesh
    std::string name;  // a
    const MeshSource& source;
    std::vector<ConfigFault>& faults;
    std::vector<std::string>& notes;

    void refuse(const std::string& sub_key, std::string got, std::string wanted) const {
        faults.push_back({source.where, sub_key.empty() ? key : key + "." + sub_key, std::move(got),
                          std::move(wanted)});
    }
};

/// The file's triangles in mm; false after a fault.
bool read_file(const Place& place, const std::string& mesh_root, std::vector<Triangle>& out) {
    const MeshSource& source = place.source;
    FileRead read = read_beneath(mesh_root, source.file, kStlBytesMax);
    if (!read.got.empty()) {
        place.refuse("file", printable(source.file) + ": " + read.got, read.wanted);
        return false;
    }
    if (!source.sha256.empty()) {
        const std::string got = sha256_hex(read.bytes);
        std::string wanted = source.sha256;
        std::transform(wanted.begin(), wanted.end(), wanted.begin(), [](char c) {
            return c >= 'A' && c <= 'F' ? static_cast<char>(c - 'A' + 'a') : c;
        });
        if (got != wanted) {  // another file: report no further faults of it
            place.refuse(
                "sha256", got + " of " + printable(source.file),
                printable(wanted) + "; restore the file, or state the hash of the new one");
            return false;
        }
    }
    StlResult stl = read_stl(read.bytes, length_of(source.unit));
    for (const StlFault& fault : stl.faults) {
        const MeshFault text = describe(fault, source.file);
        place.refuse("file", text.got, text.wanted);
    }
    if (stl.fault_count > stl.faults.size()) {
        place.refuse("file",
                     fmt::format("{}: {} more faults", printable(source.file),
                                 stl.fault_count - stl.faults.size()),
                     "a file without faults; export it again");
    }
    out = std::move(stl.triangles);
    return stl.fault_count == 0;
}

void check_size(const Place& place, const MeshReport& report) {
    const Vec3d wanted = place.source.expected_size_mm;
    const Vec3d got = widen(report.max_mm) - widen(report.min_mm);
    const std::array<std::array<double, 2>, 3> sides{
        {{got.x, wanted.x}, {got.y, wanted.y}, {got.z, wanted.z}}};
    const bool is_stated = wanted.x != 0 || wanted.y != 0 || wanted.z != 0;
    const bool fits = std::all_of(sides.begin(), sides.end(), [](const auto& side) {
        return std::fabs(side[0] - side[1]) <= kSizeToleranceRelative * side[1];
    });
    if (is_stated && !fits) {
        place.refuse("size_mm", fmt::format("[{:.6g}, {:.6g}, {:.6g}]", got.x, got.y, got.z),
                     fmt::format("[{:.6g}, {:.6g}, {:.6g}] to 1 %; check the unit and the file",
                                 wanted.x, wanted.y, wanted.z));
    }
}

// A limit of all shapes of one surface; each shape is checked like a mesh.
constexpr std::size_t kShapeTrianglesMax = 1U << 20;

bool is_in_range(const Vec3f& corner) noexcept {
    constexpr auto kMax = static_cast<float>(kCoordinateMmMax);
    return std::fabs(corner.x) <= kMax && std::fabs(corner.y) <= kMax &&
           std::fabs(corner.z) <= kMax;
}

bool are_in_range(const std::vector<Triangle>& triangles) noexcept {
    return std::all_of(triangles.begin(), triangles.end(), [](const Triangle& triangle) {
        return is_in_range(triangle.a) && is_in_range(triangle.b) && is_in_range(triangle.c);
    });
}

/// Checks a shape at its position. Returns its fault; `wanted` empty: none.
MeshFault judge_shape(const std::vector<Triangle>& triangles, std::size_t before) {
    if (before + triangles.size() > kShapeTrianglesMax) {
        return {fmt::format("{} triangles, preceding shapes included", before + triangles.size()),
                fmt::format("at most {}; use fewer segments", kShapeTrianglesMax)};
    }
    if (!are_in_range(triangles)) {
        return {"a shape beyond the largest coordinate",
                fmt::format("at most {:g} mm either way", kCoordinateMmMax)};
    }
    std::vector<std::string> notes;
    const auto faults = judge(check_mesh(triangles), MeshSource{}, "the shape", notes);
    return faults.empty() ? MeshFault{}
                          : MeshFault{faults[0].got,
                                      "a larger shape, fewer segments, or a position nearer to the "
                                      "origin; its vertices are rounded to float32"};
}

/// Appends one closed shell for each shape. Shells may overlap or contain each other.
void build_shapes(const Place& place, std::vector<Triangle>& out) {
    for (const Shape& shape : place.source.shapes) {
        const RevolutionResult built = triangles_of(shape);
        const MeshFault fault = built.status == RevolutionStatus::ok
                                    ? judge_shape(built.triangles, out.size())
                                    : describe(built, shape.segments);
        if (!fault.wanted.empty()) {
            place.faults.push_back({shape.where, shape.key, fault.got, fault.wanted});
            continue;
        }
        out.insert(out.end(), built.triangles.begin(), built.triangles.end());
    }
}

/// Replaces the surface by its swept solid about +Z.
void turn(const Place& place, std::vector<Triangle>& triangles) {
    place_triangles(place.source.at, triangles);
    RevolutionResult swept = swept_solid(triangles);
    if (swept.status != RevolutionStatus::ok || !are_in_range(swept.triangles)) {
        place.refuse(
            "", printable(place.source.file) + ": a swept profile beyond the largest coordinate",
            fmt::format("at most {:g} mm either way, at_mm and rotate_deg included",
                        kCoordinateMmMax));
        return;
    }
    place.notes.push_back(
        fmt::format("{}: turns with the spindle; {} triangles enclose the volume that its {} "
                    "triangles sweep (turns: false if it does not turn)",
                    place.key, swept.triangles.size(), triangles.size()));
    triangles = std::move(swept.triangles);
}

void load_one(const Place& place, const std::string& mesh_root, Mesh& out) {
    out.name = place.name;
    if (!place.source.shapes.empty()) {
        build_shapes(place, out.triangles);
        return;
    }
    if (!read_file(place, mesh_root, out.triangles)) {
        return;
    }
    const std::string subject = printable(place.source.file);
    const MeshReport report = check_mesh(out.triangles);
    check_size(place, report);
    std::vector<std::string> notes;
    for (const MeshFault& fault : judge(report, place.source, subject, notes)) {
        place.refuse("", fault.got, fault.wanted);
    }
    for (const std::string& note : notes) {
        place.notes.push_back(place.key + ": " + note);
    }
    prune(report.droppable, out.triangles);  // an edge of another facet covers them
    if (place.source.turns && !out.triangles.empty()) {
        turn(place, out.triangles);
    }
}

}  // namespace

std::vector<ConfigFault> load_meshes(const Machine& machine, const std::string& mesh_root,
                                     MachineMeshes& out) {
    std::vector<ConfigFault> faults;
    MachineMeshes loaded;
    loaded.bodies.resize(machine.bodies.size());
    loaded.tools.resize(machine.tools.size());
    for (std::size_t i = 0; i < machine.bodies.size(); ++i) {
        const Body& body = machine.bodies[i];
        loaded.bodies[i].name = body.name;
        if (body.has_mesh && !body.is_tool) {
            const Place place{"bodies." + body.name + ".mesh", body.name, body.mesh, faults,
                              loaded.notes};
            load_one(place, mesh_root, loaded.bodies[i]);
        }
    }
    for (std::size_t i = 0; i < machine.tools.size(); ++i) {
        const Tool& tool = machine.tools[i];
        const Place place{fmt::format("tools.{}.mesh", tool.number), tool.name, tool.mesh, faults,
                          loaded.notes};
        load_one(place, mesh_root, loaded.tools[i]);
    }
    if (faults.empty()) {
        out = std::move(loaded);
    }
    return faults;
}

}  // namespace axg
