// SPDX-License-Identifier: Apache-2.0
#include "config/mesh/mesh_faults.hpp"

#include <fmt/format.h>

namespace axg {
namespace {

constexpr const char* kExportAgain = "export the mesh again";

std::string place_of(const StlFault& fault, const std::string& file) {
    if (fault.line != 0) {
        return fmt::format("{}:{}", printable(file), fault.line);
    }
    return fmt::format("{}: byte {}", printable(file), fault.byte);
}

/// @param thing  one of them, as "open edge"
/// @param rest   what follows it, with the space
std::string facets(std::uint32_t count, const char* thing, const char* rest, std::uint32_t first) {
    return fmt::format("{} {}{}{} (first at facet {})", count, thing, count == 1 ? "" : "s", rest,
                       first);
}

/// Either a fault, or a note when the machine file allows it by name.
struct Judgement {
    const std::string& subject;
    std::vector<MeshFault>& faults;
    std::vector<std::string>& notes;

    void add(bool is_allowed, const std::string& what, const std::string& wanted,
             const std::string& consequence) const {
        if (is_allowed) {
            notes.push_back(subject + ": " + what + ", allowed: " + consequence);
        } else {
            faults.push_back({subject + ": " + what, wanted});
        }
    }
};

void judge_closed(const MeshReport& report, const MeshSource& source, const Judgement& judgement) {
    const std::string wanted =
        "a closed surface, each edge used twice in opposite directions; repair the mesh, or set "
        "allow_open: true (the guard then cannot detect a body inside this one)";
    const std::string consequence = "a body inside it is not detected";
    const bool allowed = source.allow_open;
    if (report.open_edges != 0) {
        std::string what = facets(report.open_edges, "open edge", "", report.first_open);
        if (report.t_junctions != 0) {
            what += fmt::format(", {} of their ends inside another edge (T-junctions)",
                                report.t_junctions);
        }
        judgement.add(allowed, what, wanted, consequence);
    }
    if (report.non_manifold_edges != 0) {
        judgement.add(allowed,
                      facets(report.non_manifold_edges, "edge", " used by more than two facets",
                             report.first_non_manifold),
                      wanted, consequence);
    }
    if (report.flipped_edges != 0) {
        judgement.add(allowed,
                      facets(report.flipped_edges, "edge",
                             " between facets that face opposite ways", report.first_flipped),
                      wanted, consequence);
    }
}

void judge_shells(const MeshReport& report, const MeshSource& source, const Judgement& judgement) {
    if (report.inverted_shells != 0) {
        judgement.add(false,
                      facets(report.inverted_shells, "part", " turned inside out (negative volume)",
                             report.first_inverted),
                      "facets that face outwards; flip the normals in the mesh program", "");
    }
    const std::string overlap_wanted =
        "a simple surface; unite the parts in the mesh program, or set allow_self_intersection: "
        "true";
    const std::string consequence = "the surface is used unchanged";
    // One point of a part decides whether it is nested; this is not valid for parts that cross.
    if (report.nested_shells != 0 && report.self_intersections == 0) {
        judgement.add(source.allow_self_intersection,
                      facets(report.nested_shells, "solid part", " inside another solid part",
                             report.first_nested),
                      overlap_wanted, consequence);
    }
    if (!report.shells_complete) {
        judgement.add(
            source.allow_self_intersection,
            fmt::format("{} separate parts, too many for the containment test", report.shells),
            overlap_wanted, consequence);
    }
    if (report.self_intersections != 0) {
        judgement.add(
            source.allow_self_intersection,
            fmt::format("{}{} pair{} of facets that cross or cover each other (first: {} "
                        "and {})",
                        report.self_complete ? "" : "at least ", report.self_intersections,
                        report.self_intersections == 1 ? "" : "s", report.self_a, report.self_b),
            overlap_wanted, consequence);
    } else if (!report.self_complete) {
        judgement.add(source.allow_self_intersection,
                      "too many overlapping facets to rule out self-intersection", overlap_wanted,
                      consequence);
    }
    if (report.touching_pairs != 0) {
        judgement.add(true,
                      fmt::format("{} pair{} of facets back to back", report.touching_pairs,
                                  report.touching_pairs == 1 ? "" : "s"),
                      "", "parts in contact");
    }
}

}  // namespace

std::string printable(const std::string& text) {
    std::string out;
    for (const char c : text) {
        const auto byte = static_cast<unsigned char>(c);
        if (byte >= 0x20 && byte < 0x7f) {
            out += c;
        } else {
            out += fmt::format("\\x{:02x}", byte);
        }
    }
    return out;
}

MeshFault describe(const StlFault& fault, const std::string& file) {
    const std::string where = place_of(fault, file);
    switch (fault.kind) {
        case StlFaultKind::too_large:
            return {fmt::format("{}: {} bytes", printable(file), fault.got),
                    fmt::format("at most {}; simplify the mesh, or write it as binary STL",
                                fault.wanted)};
        case StlFaultKind::too_short:
            return {fmt::format("{}: {} bytes, neither a text nor a binary STL", printable(file),
                                fault.got),
                    "an STL file: 84 bytes and 50 a facet, or a text that begins with solid"};
        case StlFaultKind::wrong_size:
            return {fmt::format("{}: {} bytes", printable(file), fault.got),
                    fmt::format("{}, from the count at byte 80; the file is truncated, has "
                                "trailing data or is not an STL file: copy or export it again",
                                fault.wanted)};
        case StlFaultKind::no_facets:
            return {fmt::format("{}: no facets", printable(file)),
                    "at least one; select the part before the export"};
        case StlFaultKind::too_many_facets:
            return {fmt::format("{}: {} facets", where, fault.got),
                    fmt::format("at most {}; simplify the mesh", fault.wanted)};
        case StlFaultKind::not_finite:
            return {
                fmt::format("{}: facet {}: {} as a coordinate", where, fault.facet, fault.value),
                fmt::format("a finite number; {}", kExportAgain)};
        case StlFaultKind::out_of_range:
            return {fmt::format("{}: facet {}: a coordinate of {:.9g} mm", where, fault.facet,
                                fault.value),
                    fmt::format("at most {:g} mm either way; check the unit", kCoordinateMmMax)};
        case StlFaultKind::bad_number:
            return {fmt::format("{}: facet {}: a word that is not a decimal number", where,
                                fault.facet),
                    "a number such as -1.25e3"};
        case StlFaultKind::unexpected_word:
            return {fmt::format("{}: facet {}: another word", where, fault.facet),
                    fmt::format("\"{}\"", fault.wanted_word)};
        case StlFaultKind::unexpected_end:
            return {fmt::format("{}: facet {}: the end of the file", where, fault.facet),
                    fmt::format("\"{}\"; the file is truncated: copy or export it again",
                                fault.wanted_word)};
        case StlFaultKind::unprintable_byte:
            return {fmt::format("{}: facet {}: byte 0x{:02x} in the text", where, fault.facet,
                                fault.got),
                    fmt::format("\"{}\" in printable ASCII (a binary STL has 84 + 50 n bytes)",
                                fault.wanted_word)};
    }
    return {where, kExportAgain};
}

MeshFault describe(const RevolutionResult& result, std::uint32_t segments) {
    const std::string point = fmt::format("point {}", result.point);
    switch (result.status) {
        case RevolutionStatus::ok:
            break;
        case RevolutionStatus::bad_segments:
            return {fmt::format("{} segments", segments),
                    fmt::format("{} to {}", kProfileSegmentsMin, kProfileSegmentsMax)};
        case RevolutionStatus::bad_point_count:
            return {"too few or too many points", fmt::format("3 to {}", kProfilePointsMax)};
        case RevolutionStatus::bad_point:
            return {point, fmt::format("[radius, height], the radius not negative, both within "
                                       "{:g} mm",
                                       kCoordinateMmMax)};
        case RevolutionStatus::ends_off_axis:
            return {point + " off the axis", "radius 0 at the first and the last point"};
        case RevolutionStatus::touches_axis:
            return {point + " on the axis", "a radius above 0 between the first and last point"};
        case RevolutionStatus::repeated_point:
            return {point + " equal to its neighbour", "each point once"};
        case RevolutionStatus::crosses_itself:
            return {fmt::format("an outline that crosses or touches itself after point {}",
                                result.point),
                    "a simple outline from axis to axis"};
        case RevolutionStatus::groove_too_narrow:
            return {fmt::format("a groove in an end face below the resolution of {} segments",
                                segments),
                    "more segments, a wider flat bottom, or no groove"};
    }
    return {"", ""};
}

std::vector<MeshFault> judge(const MeshReport& report, const MeshSource& source,
                             const std::string& subject, std::vector<std::string>& notes) {
    std::vector<MeshFault> faults;
    const Judgement judgement{subject, faults, notes};
    judge_closed(report, source, judgement);
    judge_shells(report, source, judgement);
    if (report.degenerate_facets != 0) {
        const auto dropped = static_cast<std::uint32_t>(report.droppable.size());
        judgement.add(
            source.allow_degenerate,
            facets(report.degenerate_facets, "facet", " without area", report.first_degenerate),
            "facets with area; repair the mesh, or set allow_degenerate: true",
            fmt::format("{} removed, {} kept (they may close gaps, or no other facet covers them)",
                        dropped, report.degenerate_facets - dropped));
    }
    if (report.degenerate_facets == report.facet_count) {
        judgement.add(false, "not one facet with area", "a surface", "");
    }
    if (report.doubled_facets != 0 && report.self_intersections == 0) {
        judgement.add(source.allow_self_intersection,
                      facets(report.doubled_facets, "duplicate facet", "", report.first_doubled),
                      "each facet once; repair the mesh, or set allow_self_intersection: true",
                      "the surface is used unchanged");
    }
    return faults;
}

}  // namespace axg
