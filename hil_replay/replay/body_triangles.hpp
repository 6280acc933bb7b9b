// SPDX-License-Identifier: Apache-2.0
// What an engine calls a triangle, and what a person does: reports and pages number the triangles
// of bodies and tools, an engine those of the surface that it was queried about, and a pair may
// have one of its own (Machine::pair_surfaces).
#pragma once

#include <cstdint>
#include <vector>

#include "core/collision/engine.hpp"
#include "firmware_if/setup/loaded_machine.hpp"

namespace axg {

class BodyTriangles {
  public:
    /// What it needs of `loaded` it copies.
    explicit BodyTriangles(const LoadedMachine& loaded);

    /// The same two triangles as the two bodies' own surfaces have them: as the engine was given
    /// those, simplified where they are. kNoIndex: the body has none such.
    /// @param query  of make_contact_queries(QueryScope::whole)
    [[nodiscard]] TriangleIds of(const Query& query, TriangleIds found) const noexcept;

  private:
    [[nodiscard]] std::uint32_t of(std::uint32_t mesh, std::uint32_t triangle) const noexcept;

    std::uint32_t first_;                              // of the engine's surfaces that pairs have
    std::vector<std::vector<std::uint32_t>> in_body_;  // [those surfaces][triangles]
};

}  // namespace axg
