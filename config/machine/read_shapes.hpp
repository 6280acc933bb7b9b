// SPDX-License-Identifier: Apache-2.0
// Shapes in a machine file: boxes, cylinders, cones, spheres and solids of revolution.
#pragma once

#include <string>
#include <vector>

#include "config/text/yaml_tree.hpp"
#include "core/mesh/shape.hpp"

namespace axg {

class FaultList;
class MapReader;

inline constexpr std::size_t kShapesMax = 64;  // of one surface

/// profile_mm and segments, of a tool: its whole surface.
void read_profile(MapReader& reader, FaultList& faults, Shape& out);

/// A list of shapes. `sections`: of a tool, so each has a name.
void read_shapes(const YamlNode& list, const std::string& path, FaultList& faults, bool sections,
                 std::vector<Shape>& out);

}  // namespace axg
