// SPDX-License-Identifier: Apache-2.0
// Drawings that load and can hardly be meant: a tool drawn into the spindle or in two parts, one
// body in inch among bodies in mm, a body that nothing carries. A person may mean them, so each is
// a line to review; size_is_right ends it.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/machine/machine.hpp"

namespace axg {

struct MachineMeshes;

/// A body from a file is doubted from this ratio to the median body's longest side on, if inch in
/// the place of its unit, or mm of inch, brings it nearer to the median body and to its parent.
inline constexpr double kOddRatioMin = 8;
/// A tool may reach this far above the spindle nose, and its sections may be this far apart, mm.
inline constexpr double kDrawnApartMmMax = 1;
/// A body may be apart from every other one by this share of its longest side: ways and bearings
/// are often left out of a drawing.
inline constexpr double kApartShareMax = 0.1;

/// The size of one body, for doubt_units().
struct BodySize {
    std::string name;
    LengthUnit unit = LengthUnit::mm;
    Vec3d size_mm{};                  // 0: no surface
    std::uint32_t parent = kNoIndex;  // index in the list
    bool is_doubtful = true;          // from a file, and not accepted
};

/// [sizes] empty, or both sizes and the unit that fits: "c.stl: 11.8 mm, ...; in inch 300 mm".
[[nodiscard]] std::vector<std::string> doubt_units(std::span<const BodySize> sizes);

/// One line for each doubt, with its place: "m.yaml:14: bodies.c.mesh: ...".
/// @param meshes  as load_meshes() returned them
[[nodiscard]] std::vector<std::string> doubt_drawings(const Machine& machine,
                                                      const MachineMeshes& meshes);

}  // namespace axg
