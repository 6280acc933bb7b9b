// SPDX-License-Identifier: Apache-2.0
// A solid with flat faces, each a loop of corners with loops for its holes, and its triangles: as
// many as the corners and the through holes demand (2 V - 4 + 4 g), none added.
#pragma once

#include <cstdint>
#include <vector>

#include "core/mesh/mesh.hpp"

namespace axg::generator {

using Loop = std::vector<std::uint32_t>;  // indices of corners

class Polyhedron {
  public:
    /// Adds corners and returns them as a loop, in the order given.
    Loop ring(const std::vector<Vec3d>& corners);
    /// A flat face; `outer` runs counter-clockwise seen from outside. Holes may run either way
    /// round.
    void face(const Loop& outer, const std::vector<Loop>& holes = {});
    /// Quadrangles between two loops of equal size; `from` runs counter-clockwise seen from `to`'s
    /// far side, that is: seen from above where `from` is the lower loop of an outside wall.
    void wall(const Loop& from, const Loop& to);

    /// Triangles of all faces, corners rounded to float32. Empty when a face could not be cut.
    [[nodiscard]] std::vector<Triangle> triangles() const;

  private:
    struct Face {
        Loop outer;
        std::vector<Loop> holes;
    };
    std::vector<Vec3d> corner_;
    std::vector<Face> face_;
};

/// The same corners, last one first.
[[nodiscard]] Loop reversed(const Loop& loop);

}  // namespace axg::generator
