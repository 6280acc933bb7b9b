// SPDX-License-Identifier: Apache-2.0
// Source and position of a surface: the keys that bodies and tools share.
#include <array>
#include <cmath>

#include "config/machine/read_sections.hpp"
#include "config/machine/read_shapes.hpp"
#include "config/text/fault_list.hpp"
#include "config/text/map_reader.hpp"
#include "config/text/quote_text.hpp"
#include "core/base/sincos.hpp"

namespace axg {
namespace {

/// Quarter turns come out exact: a body turned by 90 degrees must not lean by 6e-17.
SinCos sin_cos_deg(double angle_deg) noexcept {
    const double turn = std::fmod(angle_deg, 360.0);
    if (std::fmod(turn, 90.0) == 0.0) {
        const int quarter = (static_cast<int>(turn / 90.0) + 4) % 4;
        constexpr std::array<SinCos, 4> kQuarters{{{0, 1}, {1, 0}, {0, -1}, {-1, 0}}};
        return kQuarters[static_cast<std::size_t>(quarter)];
    }
    return sin_cos(turn * kPi / 180.0);
}

Pose turn_about(int axis, double angle_deg) noexcept {
    const SinCos value = sin_cos_deg(angle_deg);
    const int u = (axis + 1) % 3;
    const int v = (axis + 2) % 3;
    Pose pose;
    pose.r[u][u] = value.cos;
    pose.r[v][v] = value.cos;
    pose.r[u][v] = -value.sin;
    pose.r[v][u] = value.sin;
    return pose;
}

/// Only the form of the name is judged here; load_meshes() holds links to the folder as well.
bool stays_in_folder(const std::string& file) noexcept {
    if (file.empty() || file.front() == '/' || file.back() == '/' ||
        file.find('\\') != std::string::npos) {
        return false;
    }
    for (std::size_t at = 0; at <= file.size();) {
        const std::size_t end = std::min(file.find('/', at), file.size());
        if (file.substr(at, end - at) == "..") {
            return false;
        }
        at = end + 1;
    }
    return true;
}

void read_sha256(MapReader& reader, std::string& out) {
    std::string digest;
    if (!reader.text("sha256", Need::optional, 64, digest)) {
        return;
    }
    const bool is_digest = digest.size() == 64 &&
                           digest.find_first_not_of("0123456789abcdefABCDEF") == std::string::npos;
    if (!is_digest) {
        reader.report("sha256", quoted(digest),
                      "64 hexadecimal digits, as sha256sum prints them for the file");
        return;
    }
    for (char& c : digest) {
        c = c >= 'A' && c <= 'F' ? static_cast<char>(c - 'A' + 'a') : c;
    }
    out = digest;
}

}  // namespace

void read_mesh(const YamlNode& node, const std::string& path, FaultList& faults, MeshSource& out) {
    constexpr std::array<std::string_view, 4> kUnits{"mm", "inch", "m", "um"};
    constexpr std::array<std::string_view, 8> kOfFiles{"file",
                                                       "unit",
                                                       "sha256",
                                                       "size_mm",
                                                       "allow_open",
                                                       "allow_self_intersection",
                                                       "allow_degenerate",
                                                       "simplify_mm"};
    MapReader reader{node,
                     path,
                     {"file", "unit", "sha256", "size_mm", "allow_open", "allow_self_intersection",
                      "allow_degenerate", "simplify_mm", "shapes"},
                     faults};
    if (reader.has("shapes")) {
        out.where = faults.where(reader.line_of("shapes"));
        for (const std::string_view key : kOfFiles) {
            if (reader.has(key)) {
                reader.report(key, std::string{key} + " together with shapes",
                              "either a file or shapes; shapes are closed, and in mm");
            }
        }
        if (const YamlNode* list = reader.find("shapes", Need::required, "a list of shapes")) {
            read_shapes(*list, path + ".shapes", faults, false, out.shapes);
        }
        return;
    }
    out.where = faults.where(reader.line_of("file"));
    std::string file;
    if (reader.text("file", Need::required, 512, file)) {
        if (stays_in_folder(file)) {
            out.file = file;
        } else {
            reader.report("file", quoted(file),
                          "a path below the machine file's folder (or --mesh-root), without .., \\ "
                          "or a leading /");
        }
    }
    std::size_t unit = 0;
    if (reader.choice("unit", Need::required, kUnits, unit)) {
        out.unit = static_cast<LengthUnit>(unit);
    }
    read_sha256(reader, out.sha256);
    std::array<double, 3> size{};
    if (reader.numbers("size_mm", Need::optional, {0.001, 2 * kCoordinateMmMax}, size)) {
        out.expected_size_mm = {size[0], size[1], size[2]};
    }
    reader.boolean("allow_open", Need::optional, out.allow_open);
    reader.boolean("allow_self_intersection", Need::optional, out.allow_self_intersection);
    reader.boolean("allow_degenerate", Need::optional, out.allow_degenerate);
    reader.number("simplify_mm", Need::optional, {0.001, kSimplifyMmMax}, out.simplify_mm);
}

void read_placement(MapReader& reader, Pose& out) {
    std::array<double, 3> at{};
    std::array<double, 3> turn{};
    reader.numbers("at_mm", Need::optional, {-kCoordinateMmMax, kCoordinateMmMax}, at);
    reader.numbers("rotate_deg", Need::optional, {-360, 360}, turn);
    out = compose(turn_about(2, turn[2]), compose(turn_about(1, turn[1]), turn_about(0, turn[0])));
    for (std::size_t i = 0; i < 3; ++i) {
        out.t[i] = at[i];
    }
}

}  // namespace axg
