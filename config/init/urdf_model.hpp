// SPDX-License-Identifier: Apache-2.0
// The links and joints of a URDF file as it states them, in mm and rad.
// Source: ROS, "XML Robot Description Format" (wiki.ros.org/urdf/XML): link, joint, geometry.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "config/text/fault_list.hpp"
#include "core/base/pose.hpp"
#include "core/base/vec3.hpp"

namespace axg {

inline constexpr std::size_t kUrdfBytesMax = 8U << 20U;

enum class UrdfForm : std::uint8_t { mesh, box, cylinder, sphere };

/// One element `collision` or `visual` of a link.
struct UrdfSurface {
    UrdfForm form = UrdfForm::mesh;
    Pose at;               // to the frame of its link
    std::string file;      // of a mesh, as written
    double scale = 1;      // of a mesh: its unit in m
    Vec3d box_mm{};        // extent, centred
    double radius_mm = 0;  // of a cylinder or a sphere
    double length_mm = 0;  // of a cylinder: along Z, centred
    int line = 0;
};

struct UrdfLink {
    std::string name;
    std::vector<UrdfSurface> surfaces;  // those of `collision`; without one, those of `visual`
    int line = 0;
};

enum class UrdfMotion : std::uint8_t { fixed, revolute, continuous, prismatic };

struct UrdfJoint {
    std::string name, parent, child;  // parent and child are names of links
    UrdfMotion motion = UrdfMotion::fixed;
    Pose at;                      // the frame of the child to that of the parent, at position 0
    Vec3d axis{1, 0, 0};          // unit, in the frame of the child
    double lower = 0, upper = 0;  // mm or rad; of a continuous joint without meaning
    std::optional<double> speed;  // mm/s or rad/s
    std::string mimic;            // the joint that it follows; empty: none
    bool is_reversed = false;     // follows it the other way
    int line = 0;
};

struct UrdfModel {
    std::vector<UrdfLink> links;
    std::vector<UrdfJoint> joints;
};

/// Adds each fault with its line and the name of its link or joint.
void parse_urdf(const std::string& text, FaultList& faults, UrdfModel& out);

}  // namespace axg
