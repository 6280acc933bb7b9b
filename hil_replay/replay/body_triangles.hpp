// SPDX-License-Identifier: Apache-2.0
// Converts an engine's triangle numbers to those of reports. Reports and pages number the triangles
// of bodies and tools; an engine numbers those of the queried surface, which may belong to one pair
// (Machine::pair_surfaces).
#pragma once

#include <cstdint>
#include <vector>

#include "core/collision/engine.hpp"
#include "firmware_if/setup/loaded_machine.hpp"

namespace axg {

class BodyTriangles {
  public:
    /// Copies the required parts of `loaded`.
    explicit BodyTriangles(const LoadedMachine& loaded);

    /// Returns the numbers of the two triangles in the bodies' own surfaces as the engine received
    /// them, simplified or not. kNoIndex: the body's surface has no such triangle.
    /// @param query  of make_contact_queries(QueryScope::whole)
    [[nodiscard]] TriangleIds of(const Query& query, TriangleIds found) const noexcept;

  private:
    [[nodiscard]] std::uint32_t of(std::uint32_t mesh, std::uint32_t triangle) const noexcept;

    std::uint32_t first_;                              // first pair-specific surface of the engine
    std::vector<std::vector<std::uint32_t>> in_body_;  // [those surfaces][triangles]
};

}  // namespace axg
