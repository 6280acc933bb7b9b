// SPDX-License-Identifier: Apache-2.0
#include "config/init/urdf_model.hpp"

#ifdef AXG_HAS_TINYXML2
#include <tinyxml2.h>
#endif

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <cmath>
#include <string_view>

#include "config/text/quote_text.hpp"
#include "core/base/sincos.hpp"

namespace axg {

#ifdef AXG_HAS_TINYXML2

namespace {

using tinyxml2::XMLAttribute;
using tinyxml2::XMLElement;

constexpr double kMmInM = 1000;
constexpr double kMetresMax = 100;  // within a machine file's coordinates
constexpr double kAngleMax = 1000;  // rad
constexpr double kSpeedMax = 1e4;   // m/s, rad/s

class UrdfReader {
  public:
    UrdfReader(FaultList& faults, UrdfModel& out) : faults_(faults), out_(out) {}

    void read(const XMLElement& robot) {
        for (const XMLElement* one = robot.FirstChildElement(); one != nullptr;
             one = one->NextSiblingElement()) {
            const std::string_view kind = one->Name();
            if (kind.starts_with("xacro:")) {
                faults_.add(one->GetLineNum(), "robot", quoted(kind, 64),
                            "a URDF file; write one with xacro FILE > robot.urdf");
                return;
            }
            if (kind == "link") {
                read_link(*one);
            } else if (kind == "joint") {
                read_joint(*one);
            }
        }
    }

  private:
    static std::string name_of(const XMLElement& element) {
        const char* const name = element.Attribute("name");
        return name == nullptr ? "" : name;
    }

    /// `count` numbers within [-most, most] of an attribute; false after a fault, or if it is not
    /// stated.
    template <std::size_t count>
    bool numbers(const XMLElement* element, const char* attribute, const std::string& path,
                 double most, std::array<double, count>& out) {
        const XMLAttribute* const found =
            element == nullptr ? nullptr : element->FindAttribute(attribute);
        if (found == nullptr) {
            return false;
        }
        std::array<double, count> values{};
        const char* at = found->Value();
        const char* const end = at + std::string_view(at).size();
        std::size_t read = 0;
        const auto skip = [&at, end] {
            while (at != end && (*at == ' ' || (*at >= '\t' && *at <= '\r'))) {
                ++at;
            }
        };
        for (skip(); at != end && read < count; skip()) {
            at += *at == '+' ? 1 : 0;
            const auto [rest, error] = std::from_chars(at, end, values[read]);
            if (error != std::errc{} || !(std::fabs(values[read]) <= most)) {
                break;
            }
            at = rest;
            ++read;
        }
        if (read != count || at != end) {
            faults_.add(found->GetLineNum(), path + '.' + attribute, quoted(found->Value()),
                        count == 1 ? fmt::format("a number within {:g}", most)
                                   : fmt::format("{} numbers within {:g}", count, most));
            return false;
        }
        out = values;
        return true;
    }

    void read_origin(const XMLElement& owner, const std::string& path, Pose& out) {
        const XMLElement* const origin = owner.FirstChildElement("origin");
        std::array<double, 3> xyz{}, rpy{};
        numbers(origin, "xyz", path + ".origin", kMetresMax, xyz);
        numbers(origin, "rpy", path + ".origin", kAngleMax, rpy);
        const auto [sr, cr] = sin_cos(rpy[0]);
        const auto [sp, cp] = sin_cos(rpy[1]);
        const auto [sy, cy] = sin_cos(rpy[2]);
        const Pose roll{{{1, 0, 0}, {0, cr, -sr}, {0, sr, cr}}, {0, 0, 0}};
        const Pose pitch{{{cp, 0, sp}, {0, 1, 0}, {-sp, 0, cp}}, {0, 0, 0}};
        const Pose yaw{{{cy, -sy, 0}, {sy, cy, 0}, {0, 0, 1}}, {0, 0, 0}};
        out = compose(yaw, compose(pitch, roll));  // about the fixed x, then y, then z
        for (std::size_t i = 0; i < 3; ++i) {
            out.t[i] = kMmInM * xyz[i];
        }
    }

    void read_link(const XMLElement& element) {
        UrdfLink link;
        link.name = name_of(element);
        link.line = element.GetLineNum();
        const std::string path = "link " + escaped(link.name, 64);
        if (link.name.empty()) {
            faults_.add(link.line, "link.name", "", "the name of the link");
        }
        const char* const kind =
            element.FirstChildElement("collision") != nullptr ? "collision" : "visual";
        for (const XMLElement* one = element.FirstChildElement(kind); one != nullptr;
             one = one->NextSiblingElement(kind)) {
            read_surface(*one, path + '.' + kind, link);
        }
        out_.links.push_back(std::move(link));
    }

    void read_surface(const XMLElement& element, const std::string& path, UrdfLink& link) {
        UrdfSurface surface;
        surface.line = element.GetLineNum();
        read_origin(element, path, surface.at);
        const XMLElement* const geometry = element.FirstChildElement("geometry");
        const XMLElement* const form =
            geometry == nullptr ? nullptr : geometry->FirstChildElement();
        if (form == nullptr) {
            faults_.add(surface.line, path + ".geometry", "",
                        "a mesh, a box, a cylinder or a sphere");
            return;
        }
        surface.line = form->GetLineNum();
        const std::string_view kind = form->Name();
        if (kind == "mesh") {
            read_mesh(*form, path + ".mesh", surface);
        } else if (kind == "box") {
            std::array<double, 3> size{};
            surface.form = UrdfForm::box;
            if (is_size(*form, "size", path + ".box", size)) {
                surface.box_mm = kMmInM * Vec3d{size[0], size[1], size[2]};
            }
        } else if (kind == "cylinder" || kind == "sphere") {
            std::array<double, 1> radius{}, length{};
            const std::string here = path + '.' + std::string(kind);
            surface.form = kind == "sphere" ? UrdfForm::sphere : UrdfForm::cylinder;
            if (is_size(*form, "radius", here, radius) &&
                (kind == "sphere" || is_size(*form, "length", here, length))) {
                surface.radius_mm = kMmInM * radius[0];
                surface.length_mm = kMmInM * length[0];
            }
        } else {
            faults_.add(surface.line, path + ".geometry", quoted(kind, 64),
                        "a mesh, a box, a cylinder or a sphere");
            return;
        }
        link.surfaces.push_back(std::move(surface));
    }

    /// Numbers above 0 of an attribute that has to be there.
    template <std::size_t count>
    bool is_size(const XMLElement& element, const char* attribute, const std::string& path,
                 std::array<double, count>& out) {
        const std::size_t before = faults_.count();
        const bool is_read = numbers(&element, attribute, path, kMetresMax, out);
        bool is_above = true;
        for (const double one : out) {
            is_above &= one > 1e-6;
        }
        if (faults_.count() == before && !(is_read && is_above)) {
            const char* const text = element.Attribute(attribute);
            faults_.add(element.GetLineNum(), path + '.' + attribute,
                        text == nullptr ? "" : quoted(text), "a size above 0 in m");
        }
        return is_read && is_above;
    }

    void read_mesh(const XMLElement& element, const std::string& path, UrdfSurface& out) {
        const char* const file = element.Attribute("filename");
        if (file == nullptr || *file == '\0') {
            faults_.add(out.line, path + ".filename", "", "the name of an STL file");
            return;
        }
        out.file = file;
        std::array<double, 3> scale{1, 1, 1};
        numbers(&element, "scale", path, 1e6, scale);
        out.scale = scale[0];
        if (scale[0] != scale[1] || scale[0] != scale[2] || !(scale[0] > 0)) {
            faults_.add(out.line, path + ".scale", quoted(element.Attribute("scale")),
                        "one scale above 0 for x, y and z; stretch or mirror the mesh itself");
        }
    }

    void read_joint(const XMLElement& element) {
        UrdfJoint joint;
        joint.name = name_of(element);
        joint.line = element.GetLineNum();
        const std::string path = "joint " + escaped(joint.name, 64);
        if (joint.name.empty()) {
            faults_.add(joint.line, "joint.name", "", "the name of the joint");
        }
        for (const auto& [kind, target] :
             {std::pair{"parent", &joint.parent}, std::pair{"child", &joint.child}}) {
            const XMLElement* const link = element.FirstChildElement(kind);
            const char* const name = link == nullptr ? nullptr : link->Attribute("link");
            *target = name == nullptr ? "" : name;
            if (target->empty()) {
                faults_.add(joint.line, path + '.' + kind, "", "the name of a link");
            }
        }
        read_origin(element, path, joint.at);
        const char* const type = element.Attribute("type");
        const std::string_view word = type == nullptr ? "" : type;
        if (word == "fixed") {
            out_.joints.push_back(std::move(joint));
            return;
        }
        if (word != "revolute" && word != "continuous" && word != "prismatic") {
            faults_.add(joint.line, path + ".type", type == nullptr ? "" : quoted(word, 64),
                        "fixed, revolute, continuous or prismatic; replace this joint");
            return;
        }
        joint.motion = word == "revolute"     ? UrdfMotion::revolute
                       : word == "continuous" ? UrdfMotion::continuous
                                              : UrdfMotion::prismatic;
        read_axis(element, path, joint);
        read_mimic(element, path, joint);
        read_limits(element, path, joint);
        out_.joints.push_back(std::move(joint));
    }

    void read_axis(const XMLElement& element, const std::string& path, UrdfJoint& out) {
        const XMLElement* const axis = element.FirstChildElement("axis");
        std::array<double, 3> d{1, 0, 0};
        numbers(axis, "xyz", path + ".axis", kMetresMax, d);
        const double length = std::sqrt((d[0] * d[0] + d[1] * d[1]) + d[2] * d[2]);
        if (!(length > 1e-6)) {
            faults_.add(axis->GetLineNum(), path + ".axis", quoted(axis->Attribute("xyz")),
                        "a direction");
            return;
        }
        out.axis = (1 / length) * Vec3d{d[0], d[1], d[2]};
    }

    void read_mimic(const XMLElement& element, const std::string& path, UrdfJoint& out) {
        const XMLElement* const mimic = element.FirstChildElement("mimic");
        if (mimic == nullptr) {
            return;
        }
        const char* const joint = mimic->Attribute("joint");
        std::array<double, 1> multiplier{1}, offset{0};
        numbers(mimic, "multiplier", path + ".mimic", 1e6, multiplier);
        numbers(mimic, "offset", path + ".mimic", 1e6, offset);
        if (joint == nullptr || std::fabs(multiplier[0]) != 1 || offset[0] != 0) {
            faults_.add(mimic->GetLineNum(), path + ".mimic",
                        joint == nullptr
                            ? ""
                            : fmt::format("multiplier {:g}, offset {:g}", multiplier[0], offset[0]),
                        "a joint, multiplier 1 or -1, offset 0; give a joint of another ratio its "
                        "own axis");
            return;
        }
        out.mimic = joint;
        out.is_reversed = multiplier[0] < 0;
    }

    void read_limits(const XMLElement& element, const std::string& path, UrdfJoint& out) {
        const XMLElement* const limit = element.FirstChildElement("limit");
        std::array<double, 1> lower{0}, upper{0}, velocity{0};
        const std::string here = path + ".limit";
        const double unit = out.motion == UrdfMotion::prismatic ? kMmInM : 1;
        const double most = out.motion == UrdfMotion::prismatic ? kMetresMax : kAngleMax;
        if (numbers(limit, "velocity", here, kSpeedMax, velocity) && velocity[0] > 0) {
            out.speed = unit * velocity[0];
        }
        if (out.motion == UrdfMotion::continuous || !out.mimic.empty()) {
            return;
        }
        const std::size_t before = faults_.count();
        numbers(limit, "lower", here, most, lower);
        numbers(limit, "upper", here, most, upper);
        out.lower = unit * lower[0];
        out.upper = unit * upper[0];
        if (faults_.count() == before && !(lower[0] < upper[0])) {
            faults_.add(
                limit == nullptr ? out.line : limit->GetLineNum(), here,
                limit == nullptr ? "" : fmt::format("lower {:g}, upper {:g}", lower[0], upper[0]),
                "lower below upper; give a joint that cannot move the type fixed");
        }
    }

    FaultList& faults_;
    UrdfModel& out_;
};

}  // namespace

void parse_urdf(const std::string& text, FaultList& faults, UrdfModel& out) {
    tinyxml2::XMLDocument document;
    if (document.Parse(text.data(), text.size()) != tinyxml2::XML_SUCCESS) {
        faults.add(document.ErrorLineNum(), "XML", document.ErrorName(), "well-formed XML");
        return;
    }
    const XMLElement* const robot = document.RootElement();
    if (robot == nullptr || std::string_view(robot->Name()) != "robot") {
        faults.add(robot == nullptr ? 1 : robot->GetLineNum(), "root",
                   robot == nullptr ? "" : quoted(robot->Name(), 64), "an element robot");
        return;
    }
    UrdfReader(faults, out).read(*robot);
}

#else

void parse_urdf(const std::string&, FaultList& faults, UrdfModel&) {
    faults.add(1, "robot", "an axguard built without tinyxml2",
               "one with it; run axguard init where it is installed");
}

#endif

}  // namespace axg
