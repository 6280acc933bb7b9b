// SPDX-License-Identifier: Apache-2.0
#include "config/machine/read_shapes.hpp"
#include "config/machine/read_sections.hpp"

#include <array>
#include <cmath>

#include "config/text/fault_list.hpp"
#include "config/text/map_reader.hpp"
#include "config/text/nearest_word.hpp"
#include "config/text/quote_text.hpp"

namespace axg {
namespace {

constexpr Range kSizeMm{0.001, kCoordinateMmMax};
constexpr std::array<std::string_view, 5> kKinds{"box_mm", "cylinder", "cone", "sphere",
                                                 "profile_mm"};

/// A profile closes on the axis at both ends: otherwise what it turns into has a hole.
void read_points(MapReader& reader, FaultList& faults, std::vector<Vec3d>& out) {
    const YamlNode* list = reader.find("profile_mm", Need::required, "a list of [radius, height]");
    if (list == nullptr) {
        return;
    }
    const std::size_t count = list->entries.size();
    if (list->kind != YamlNode::Kind::sequence || count < 3 || count > kProfilePointsMax) {
        reader.report("profile_mm", shown(*list),
                      "a list of 3 to " + std::to_string(kProfilePointsMax) +
                          " points [radius, height], tip first");
        return;
    }
    const std::string path = reader.path_of("profile_mm");
    for (std::size_t i = 0; i < count; ++i) {
        const YamlEntry& item = list->entries[i];
        const std::string at = path + '[' + std::to_string(i) + ']';
        std::array<double, 2> point{};
        if (!read_numbers({item.value, at, faults}, {-kCoordinateMmMax, kCoordinateMmMax}, point)) {
            continue;
        }
        const bool is_end = i == 0 || i + 1 == count;
        const Vec3d here{point[0], 0, point[1]};
        if (point[0] < 0 || (is_end && point[0] != 0)) {
            faults.add(item.line, at, "the radius " + shown(point[0]),
                       is_end ? "0 at the first and the last point; the profile ends on the axis"
                              : "a radius of 0 or more");
        } else if (!out.empty() && out.back() == here) {
            faults.add(item.line, at, "the same point twice", "each point once");
        }
        out.push_back(here);
    }
}

void read_cone(const YamlNode& node, const std::string& path, bool is_cylinder, FaultList& faults,
               Shape& out) {
    MapReader reader =
        is_cylinder ? MapReader{node, path, {"radius_mm", "height_mm"}, faults}
                    : MapReader{node, path, {"radius_mm", "top_radius_mm", "height_mm"}, faults};
    double radius_mm = 0, top_mm = 0, height_mm = 0;
    const bool has_radius = reader.number("radius_mm", Need::required, kSizeMm, radius_mm);
    const bool has_height = reader.number("height_mm", Need::required, kSizeMm, height_mm);
    reader.number("top_radius_mm", Need::optional, {0, kCoordinateMmMax}, top_mm);
    if (has_radius && has_height) {
        out.profile = cone_profile(radius_mm, is_cylinder ? radius_mm : top_mm, height_mm);
    }
}

void read_sphere(const YamlNode& node, const std::string& path, FaultList& faults, Shape& out) {
    MapReader reader{node, path, {"radius_mm"}, faults};
    double radius_mm = 0;
    if (reader.number("radius_mm", Need::required, kSizeMm, radius_mm)) {
        out.profile = sphere_profile(radius_mm, out.segments);
    }
}

void read_kind(MapReader& reader, std::string_view kind, FaultList& faults, Shape& out) {
    if (kind == "profile_mm") {
        read_points(reader, faults, out.profile);
        return;
    }
    if (kind == "box_mm") {
        std::array<double, 3> size{};
        if (reader.numbers(kind, Need::required, kSizeMm, size)) {
            out.box_mm = {size[0], size[1], size[2]};
        }
        return;
    }
    const YamlNode* node = reader.find(kind, Need::required, "a map with its sizes");
    if (node != nullptr && kind == "sphere") {
        read_sphere(*node, reader.path_of(kind), faults, out);
    } else if (node != nullptr) {
        read_cone(*node, reader.path_of(kind), kind == "cylinder", faults, out);
    }
}

void read_shape(MapReader& reader, FaultList& faults, Shape& out) {
    std::string_view kind;
    std::string got;
    for (const std::string_view one : kKinds) {
        if (reader.has(one)) {
            got.append(got.empty() ? "" : " and ").append(one);
            kind = kind.empty() ? one : kind;
        }
    }
    if (got.size() != kind.size() || kind.empty()) {
        faults.add(reader.node().line, out.key, got.empty() ? "no shape" : got,
                   "one of " + listed(kKinds));
        return;
    }
    read_placement(reader, out.at);
    const bool is_round = kind != "box_mm";
    if (is_round) {
        reader.whole("segments", Need::optional, {kProfileSegmentsMin, kProfileSegmentsMax},
                     out.segments);
    } else if (reader.has("segments")) {
        reader.report("segments", "segments of a box", "no such key with box_mm");
    }
    read_kind(reader, kind, faults, out);
}

}  // namespace

void read_profile(MapReader& reader, FaultList& faults, Shape& out) {
    out.key = reader.path_of("profile_mm");
    out.where = faults.where(reader.line_of("profile_mm"));
    read_points(reader, faults, out.profile);
    reader.whole("segments", Need::optional, {kProfileSegmentsMin, kProfileSegmentsMax},
                 out.segments);
}

void read_shapes(const YamlNode& list, const std::string& path, FaultList& faults, bool sections,
                 std::vector<Shape>& out) {
    const std::size_t count = list.entries.size();
    if (list.kind != YamlNode::Kind::sequence || count == 0 || count > kShapesMax) {
        faults.add(
            list.line, path, shown(list),
            "a list of 1 to " + std::to_string(kShapesMax) + (sections ? " sections" : " shapes"));
        return;
    }
    for (std::size_t i = 0; i < count; ++i) {
        const YamlEntry& item = list.entries[i];
        Shape shape;
        shape.key = path + '[' + std::to_string(i) + ']';
        shape.where = faults.where(item.line);
        MapReader reader =
            sections ? MapReader{item.value,
                                 shape.key,
                                 {"name", "cutting", "box_mm", "cylinder", "cone", "sphere",
                                  "profile_mm", "segments", "at_mm", "rotate_deg"},
                                 faults}
                     : MapReader{item.value,
                                 shape.key,
                                 {"box_mm", "cylinder", "cone", "sphere", "profile_mm", "segments",
                                  "at_mm", "rotate_deg"},
                                 faults};
        if (sections) {
            reader.name("name", Need::required, shape.name);
            reader.boolean("cutting", Need::optional, shape.is_cutting);
        }
        if (item.value.kind == YamlNode::Kind::map) {
            read_shape(reader, faults, shape);
        }
        out.push_back(std::move(shape));
    }
}

}  // namespace axg
