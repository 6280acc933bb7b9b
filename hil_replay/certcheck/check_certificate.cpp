// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/certcheck/check_certificate.hpp"

#include <algorithm>

#include "hil_replay/certcheck/check_task.hpp"
#include "hil_replay/certcheck/look_up.hpp"

namespace axg::certcheck {
namespace {

constexpr std::size_t kExclusionsShown = 12;

std::string hex(const Digest& digest) {
    std::string text;
    for (const std::uint8_t byte : digest) {
        text += "0123456789abcdef"[byte >> 4];
        text += "0123456789abcdef"[byte & 15];
    }
    return text;
}

std::string number(double value) {
    std::string text = std::to_string(value);
    text.erase(text.find_last_not_of('0') + 1);
    return text.back() == '.' ? text.substr(0, text.size() - 1) : text;
}

std::string axis_line(const Axis& axis, std::int64_t delta, std::int64_t following) {
    const double unit = axis.unit * (axis.is_rotary ? 57.29577951308232 : 1);
    return "  " + axis.name + ": delta " + number(static_cast<double>(delta) * unit) + ", f " +
           number(static_cast<double>(following) * unit) + (axis.is_rotary ? " deg\n" : " mm\n");
}

/// What a reader must compare with the machine and the program: without a tool no pair with one is
/// judged, and nothing can be inside of an open part.
std::string extent_of(const Model& model, const Certificate& claim, const Tally& tally,
                      const std::map<std::uint32_t, Parts>& parts) {
    std::string text = "path: " + std::to_string(claim.segments()) + " segments in " +
                       std::to_string(claim.runs()) + " runs; " +
                       std::to_string(std::ranges::count(tally.is_hole, true)) +
                       " of them with a hole, of which nothing is claimed\n";
    const auto tool = [&](const std::string& name, int place) {
        if (const std::uint64_t segments = claim.segments_with(place); segments > 0) {
            text += "  " + name + ": " + std::to_string(segments) + " segments\n";
        }
    };
    for (std::size_t i = 0; i < model.tools.size(); ++i) {
        tool(model.tools[i], static_cast<int>(i));
    }
    tool("every tool", kEveryTool);
    tool("no tool, and no pair with one is judged", -1);
    double margin = std::numeric_limits<double>::infinity();
    for (const Task& task : model.tasks) {
        margin = std::min(margin, task.margin);
    }
    std::size_t open = 0;
    for (const auto& [surface, of_surface] : parts) {
        open += of_surface.open_count;
    }
    return text + "pairs: " + std::to_string(model.tasks.size()) + ", with " +
           std::to_string(tally.boxes) + " boxes; margin " + number(margin) +
           " mm or more; containment at " + std::to_string(tally.places) + " places; " +
           std::to_string(open) + " open parts, which nothing can be inside of\n";
}

std::string claims_of(const Model& model, const Certificate& claim, const Tally& tally,
                      const std::map<std::uint32_t, Parts>& parts) {
    std::string text;
    for (const auto& [name, sum] : claim.references) {
        text += "  " + std::string(name) + std::string(10 - name.size(), ' ') + hex(sum) + "\n";
    }
    text += std::string("promise: ") + (model.is_independent ? "independent" : "path_keeping") +
            "; written by axguard " + claim.version + "\n";
    for (std::size_t i = 0; i < model.axes.size(); ++i) {
        text += axis_line(model.axes[i], claim.delta[i], claim.following[i]);
    }
    text += extent_of(model, claim, tally, parts);
    text += "excluded pairs: " + std::to_string(model.exclusions.size()) + "\n";
    for (std::size_t i = 0; i < std::min(model.exclusions.size(), kExclusionsShown); ++i) {
        const Exclusion& pair = model.exclusions[i];
        const auto body = [&](int side) {
            return model.bodies[static_cast<std::size_t>(pair.body[side])].name;
        };
        text += "  " + body(0) + ", " + body(1) + ": " + pair.reason + "\n";
    }
    if (model.exclusions.size() > kExclusionsShown) {
        text += "  and " + std::to_string(model.exclusions.size() - kExclusionsShown) + " more\n";
    }
    return text;
}

}  // namespace

Outcome check_certificate(const NamedBytes& model_file, const NamedBytes& certificate_file,
                          const NamedBytes& positions) {
    try {
        const Model model = read_model(model_file.name, model_file.bytes);
        Sections sections(certificate_file.name, certificate_file.bytes);
        const Certificate claim(model, sections, sha256(model_file.bytes));
        Tally tally;
        tally.is_hole.resize(claim.segments());
        std::map<std::uint32_t, Parts> parts;
        for (std::size_t i = 0; i < model.tasks.size(); ++i) {
            TaskCheck(model, claim, i).run(sections.open("PAIR"), parts, tally);
        }
        sections.end();
        const auto holes = std::ranges::count(tally.is_hole, true);
        std::string text = certificate_file.name + ": proven" +
                           (holes == 0 ? "" : ", except for its holes") + "\n" +
                           claims_of(model, claim, tally, parts);
        if (positions.name.empty()) {
            return {0, text};
        }
        const LookUp found =
            look_up(positions.name, {positions.bytes.begin(), positions.bytes.end()}, model, claim,
                    tally.is_hole);
        text += positions.name + ": " + std::to_string(found.positions) + " positions, " +
                std::to_string(found.outside) + " outside of the tube";
        text += found.outside == 0
                    ? "\n"
                    : ", the first in line " + std::to_string(found.first_outside) + "\n";
        return {found.outside == 0 ? 0 : 10, text};
    } catch (const Refusal& refusal) {
        return {refusal.exit_code, refusal.text + "\n"};
    }
}

}  // namespace axg::certcheck
