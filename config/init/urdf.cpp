// SPDX-License-Identifier: Apache-2.0
#include "config/init/urdf.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string_view>
#include <utility>

#include "config/init/urdf_model.hpp"
#include "config/mesh/survey_mesh.hpp"
#include "config/text/fault_list.hpp"
#include "config/text/quote_text.hpp"
#include "core/base/limits.hpp"
#include "core/base/sincos.hpp"

namespace axg {
namespace {

constexpr std::uint32_t kFrameAxes = 8;  // of the frames that init writes no ids for

/// Without the last digits of a sine: 6e-17 becomes 0.
double rounded(double value, double parts) noexcept {
    return std::round(value * parts) / parts + 0.0;
}

Vec3d rounded(Vec3d v, double parts) noexcept {
    return {rounded(v.x, parts), rounded(v.y, parts), rounded(v.z, parts)};
}

// URDF files state pi with ten digits or more: what these leave out vanishes.
constexpr double kPartsOfMm = 1e6, kPartsOfDegree = 1e7, kPartsOfUnit = 1e9;

std::string list_of(Vec3d v) {
    return fmt::format("[{:.10g}, {:.10g}, {:.10g}]", v.x, v.y, v.z);
}

Vec3d place_of(const Pose& pose) noexcept {
    return rounded({pose.t[0], pose.t[1], pose.t[2]}, kPartsOfMm);
}

/// The angles of rotate_deg: about the fixed x, then y, then z.
Vec3d angles_of(const Pose& pose) noexcept {
    const auto& r = pose.r;
    const double level = std::sqrt(r[0][0] * r[0][0] + r[1][0] * r[1][0]);
    const bool is_upright = level < 1e-9;  // x and z then turn about the same line: z is 0
    const double x = is_upright ? std::atan2(-r[1][2], r[1][1]) : std::atan2(r[2][1], r[2][2]);
    const double y = std::atan2(-r[2][0], level);
    const double z = is_upright ? 0 : std::atan2(r[1][0], r[0][0]);
    constexpr double kDegrees = 180 / kPi;
    return rounded({kDegrees * x, kDegrees * y, kDegrees * z}, kPartsOfDegree);
}

std::string shape_text(const UrdfSurface& surface) {
    // A machine file's box and cylinder begin at z = 0, those of URDF are centred.
    const double below_mm = surface.form == UrdfForm::box        ? surface.box_mm.z / 2
                            : surface.form == UrdfForm::cylinder ? surface.length_mm / 2
                                                                 : 0;
    const Pose at = compose(surface.at, Pose{.t = {0, 0, -below_mm}});
    std::string text;
    if (surface.form == UrdfForm::box) {
        text = fmt::format("{{box_mm: {}", list_of(rounded(surface.box_mm, kPartsOfMm)));
    } else if (surface.form == UrdfForm::cylinder) {
        text = fmt::format("{{cylinder: {{radius_mm: {:.10g}, height_mm: {:.10g}}}",
                           surface.radius_mm, surface.length_mm);
    } else {
        text = fmt::format("{{sphere: {{radius_mm: {:.10g}}}", surface.radius_mm);
    }
    if (place_of(at) != Vec3d{}) {
        text += fmt::format(", at_mm: {}", list_of(place_of(at)));
    }
    if (angles_of(at) != Vec3d{}) {
        text += fmt::format(", rotate_deg: {}", list_of(angles_of(at)));
    }
    return text + '}';
}

class MachineBuilder {
  public:
    MachineBuilder(const UrdfModel& model, const std::string& name,
                   const std::function<bool(const std::string&)>& has_file, FaultList& faults,
                   UrdfMachine& out)
        : model_(model), name_(name), has_file_(has_file), faults_(faults), out_(out) {}

    void build() {
        if (!find_links() || !name_axes()) {
            return;
        }
        struct Visit {
            std::size_t link;
            const UrdfJoint* joint;  // that carries it; null: the machine's frame does
            Pose at;                 // of the joint's parent
            std::uint32_t parent;
        };
        std::vector<Visit> left{{root_, nullptr, Pose{}, kNoParent}};
        std::size_t visited = 0;
        while (!left.empty()) {
            const Visit now = left.back();
            left.pop_back();
            ++visited;
            const UrdfLink& link = model_.links[now.link];
            const Pose at = now.joint == nullptr ? now.at : compose(now.at, now.joint->at);
            const std::uint32_t body = add_link(link, now.joint, at, now.parent);
            for (std::size_t i = model_.joints.size(); i-- > 0;) {  // the first is visited first
                if (model_.joints[i].parent == link.name) {
                    left.push_back(
                        {links_.at(model_.joints[i].child), &model_.joints[i], at, body});
                }
            }
        }
        if (visited != model_.links.size()) {
            faults_.add(model_.links[root_].line, "robot", "links in a circle",
                        "a tree: every link hangs on one that is nearer to the root");
        }
        if (faults_.empty() && (out_.roles.size() < 2 || out_.roles.size() > kBodiesMax)) {
            faults_.add(model_.links[root_].line, "robot",
                        fmt::format("{} bodies", out_.roles.size()),
                        fmt::format("2 to {}; remove the surfaces of links that need no check",
                                    kBodiesMax));
        }
    }

  private:
    /// Each link once, each joint between two of them, and one link that no joint carries.
    bool find_links() {
        for (std::size_t i = 0; i < model_.links.size(); ++i) {
            const UrdfLink& link = model_.links[i];
            if (!links_.emplace(link.name, i).second) {
                faults_.add(link.line, "link " + escaped(link.name, 64),
                            "a second link of this name", "each name once");
            }
        }
        std::map<std::string, const UrdfJoint*> carriers;
        for (const UrdfJoint& joint : model_.joints) {
            const std::string path = "joint " + escaped(joint.name, 64);
            for (const auto& [key, link] :
                 {std::pair{".parent", &joint.parent}, std::pair{".child", &joint.child}}) {
                if (links_.count(*link) == 0) {
                    faults_.add(joint.line, path + key, quoted(*link, 64), "a link of this file");
                }
            }
            if (!carriers.emplace(joint.child, &joint).second) {
                faults_.add(joint.line, path + ".child", quoted(joint.child, 64),
                            "a link that no other joint carries; a closed chain is no tree");
            }
        }
        std::size_t roots = 0;
        for (std::size_t i = 0; i < model_.links.size(); ++i) {
            if (carriers.count(model_.links[i].name) == 0) {
                root_ = roots++ == 0 ? i : root_;
                if (roots > 1) {
                    faults_.add(model_.links[i].line, "link " + escaped(model_.links[i].name, 64),
                                "a second link that no joint carries", "one root; add its joint");
                }
            }
        }
        if (roots == 0) {
            faults_.add(1, "robot", fmt::format("{} links without a root", model_.links.size()),
                        "a link that no joint carries");
        }
        return faults_.empty();
    }

    /// A letter where the joint's name contains the one of a fitting axis, else J1, J2...
    bool name_axes() {
        std::map<char, int> taken;
        for (const UrdfJoint& joint : model_.joints) {
            taken[letter_of(joint)] += joint.motion != UrdfMotion::fixed && joint.mimic.empty();
        }
        int number = 0;
        for (const UrdfJoint& joint : model_.joints) {
            if (joint.motion == UrdfMotion::fixed || !joint.mimic.empty()) {
                continue;
            }
            const char letter = letter_of(joint);
            const bool has_letter = letter != '\0' && taken[letter] == 1;
            ++number;
            IniAxis axis;
            axis.name = has_letter ? std::string(1, letter) : fmt::format("J{}", number);
            axis.is_rotary = joint.motion != UrdfMotion::prismatic;
            axis.is_unlimited = joint.motion == UrdfMotion::continuous;
            const double unit = axis.is_rotary ? 180 / kPi : 1;
            if (!axis.is_unlimited) {
                axis.min = rounded(unit * joint.lower, kPartsOfMm);
                axis.max = rounded(unit * joint.upper, kPartsOfMm);
            }
            if (joint.speed) {
                axis.speed = rounded(unit * *joint.speed, kPartsOfMm);
            }
            if (!axes_.emplace(joint.name, axis.name).second) {
                faults_.add(joint.line, "joint " + escaped(joint.name, 64),
                            "a second joint of this name", "each name once");
            }
            rotary_[axis.name] = axis.is_rotary;
            out_.axes.axes.push_back(std::move(axis));
        }
        for (const UrdfJoint& joint : model_.joints) {
            const auto leader = axes_.find(joint.mimic);
            if (!joint.mimic.empty() &&
                (leader == axes_.end() ||
                 rotary_[leader->second] != (joint.motion != UrdfMotion::prismatic))) {
                faults_.add(joint.line, "joint " + escaped(joint.name, 64) + ".mimic",
                            quoted(joint.mimic, 64),
                            "a joint of the same type that follows no other");
            }
        }
        if (number == 0 || static_cast<std::uint32_t>(number) > kFrameAxes) {
            faults_.add(
                1, "robot", fmt::format("{} joints that move", number),
                fmt::format("1 to {}; give joints that need no check type fixed", kFrameAxes));
        }
        return faults_.empty();
    }

    static char letter_of(const UrdfJoint& joint) {
        const char letter = axis_in(joint.name);
        const bool is_rotary = letter >= 'A' && letter <= 'C';
        return is_rotary == (joint.motion != UrdfMotion::prismatic) ? letter : '\0';
    }

    /// Adds the bodies of a link: one a mesh, one for all its shapes; those behind the first are
    /// fixed to it. A link without surfaces is a body only if a joint moves it.
    std::uint32_t add_link(const UrdfLink& link, const UrdfJoint* joint, const Pose& at,
                           std::uint32_t parent) {
        std::vector<RoleGuess> pieces;
        std::string shapes;
        for (const UrdfSurface& surface : link.surfaces) {
            if (surface.form != UrdfForm::mesh) {
                shapes += (shapes.empty() ? "" : ", ") + shape_text(surface);
                continue;
            }
            RoleGuess piece;
            const Pose place = compose(at, surface.at);
            piece.at_mm = place_of(place);
            piece.rotate_deg = angles_of(place);
            piece.file = mesh_of(link, surface);
            pieces.push_back(std::move(piece));
        }
        const bool moves = joint != nullptr && joint->motion != UrdfMotion::fixed;
        if (!shapes.empty() || (pieces.empty() && moves)) {
            RoleGuess piece;
            piece.at_mm = place_of(at);
            piece.rotate_deg = angles_of(at);
            piece.file = kNoFile;
            piece.shapes = shapes;
            pieces.push_back(std::move(piece));
        }
        std::uint32_t first = parent;
        for (std::size_t i = 0; i < pieces.size(); ++i) {
            RoleGuess& piece = pieces[i];
            piece.is_stated = true;
            piece.name = legal_name(link.name, out_.roles);
            piece.parent = first;
            if (i == 0) {
                first = static_cast<std::uint32_t>(out_.roles.size());
                if (moves) {
                    move(*joint, at, piece);
                }
            }
            out_.roles.push_back(std::move(piece));
        }
        return first;
    }

    void move(const UrdfJoint& joint, const Pose& at, RoleGuess& out) {
        out.axis = axes_.at(joint.mimic.empty() ? joint.name : joint.mimic);
        const Vec3d direction = rotate(at, joint.axis);
        out.direction = rounded(joint.is_reversed ? Vec3d{} - direction : direction, kPartsOfUnit);
        out.pivot_mm = place_of(at);
        out.axis_note = fmt::format("joint {}, {}:{}", escaped(joint.name, 64), name_, joint.line);
    }

    /// Index of the mesh and its unit.
    std::uint32_t mesh_of(const UrdfLink& link, const UrdfSurface& surface) {
        const std::string path = "link " + escaped(link.name, 64) + ".mesh";
        constexpr std::array<LengthUnit, 4> kUnits{LengthUnit::mm, LengthUnit::inch, LengthUnit::m,
                                                   LengthUnit::um};
        const auto unit = std::find_if(kUnits.begin(), kUnits.end(), [&surface](LengthUnit one) {
            return std::fabs(1000 * surface.scale / length_of(one) - 1) < 1e-6;
        });
        if (unit == kUnits.end()) {
            faults_.add(surface.line, path + ".scale", fmt::format("{:g}", surface.scale),
                        "1, 0.001, 0.0254 or 0.000001: a file in m, mm, inch or um");
            return kNoFile;
        }
        const std::string file = file_of(surface.file);
        std::string ending = file.substr(std::min(file.size(), file.find_last_of('.')));
        std::transform(ending.begin(), ending.end(), ending.begin(), [](char c) {
            return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
        });
        if (ending != ".stl" || !has_file_(file)) {
            faults_.add(surface.line, path + ".filename", quoted(surface.file, 400),
                        ending != ".stl"
                            ? "an STL file; convert the mesh and change its name here"
                            : "a file below the folder of the meshes; pass it with --meshes DIR");
            return kNoFile;
        }
        const auto found = std::find_if(
            out_.meshes.begin(), out_.meshes.end(),
            [&](const UrdfMesh& mesh) { return mesh.file == file && mesh.unit == *unit; });
        const auto place = static_cast<std::uint32_t>(found - out_.meshes.begin());
        if (found == out_.meshes.end()) {
            out_.meshes.push_back({file, *unit});
        }
        return place;
    }

    /// "package://robot/meshes/a.stl" to the longest end of it that the folder contains.
    [[nodiscard]] std::string file_of(std::string path) const {
        const std::size_t scheme = path.find("://");
        path.erase(0, scheme == std::string::npos ? 0 : scheme + 3);
        if (const std::size_t up = path.rfind("../"); up != std::string::npos) {
            path.erase(0, up + 3);
        }
        std::string shorter = path;
        while (!shorter.empty()) {
            if (shorter[0] != '/' && has_file_(shorter)) {
                return shorter;
            }
            const std::size_t slash = shorter.find('/');
            shorter.erase(0, slash == std::string::npos ? shorter.size() : slash + 1);
        }
        return path;
    }

    const UrdfModel& model_;
    const std::string& name_;
    const std::function<bool(const std::string&)>& has_file_;
    FaultList& faults_;
    UrdfMachine& out_;
    std::size_t root_ = 0;
    std::map<std::string, std::size_t> links_;  // by name
    std::map<std::string, std::string> axes_;   // of a joint
    std::map<std::string, bool> rotary_;        // of an axis
};

}  // namespace

UrdfMachine read_urdf(const std::string& text, const std::string& name,
                      const std::function<bool(const std::string&)>& has_file) {
    FaultList faults(name);
    UrdfMachine machine;
    machine.axes.exceeds_limits = false;
    UrdfModel model;
    parse_urdf(text, faults, model);
    if (faults.empty()) {
        MachineBuilder(model, name, has_file, faults, machine).build();
    }
    machine.faults = faults.in_order();
    return machine;
}

}  // namespace axg
